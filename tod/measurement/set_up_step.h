// What has to be known of a set-up before anything in it is judged, whether its plate rests or runs: where the plate
// is, which way its triangles differ, which contrast the camera sees. One room for both, with the same checks and
// sentences.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/grey_levels.h"
#include "tod/measurement/measurement.h"
#include "tod/measurement/saturation_watch.h"
#include "tod/presentation/target.h"
#include "tod/registration/registration.h"

namespace todbench {

/// What frames are taken by. With contrasts in grey levels a frame has its counts in place of kelvin.
[[nodiscard]] FrameTakerOptions taker_options(const MeasurementOptions& options, const SourceInfo& camera,
                                              std::function<void(const RejectedFrame&)> on_rejected = {});

/// Before the camera is started. Errors: `calibration` (counts without temperature, where the contrast is in kelvin),
/// `invalid_input` (sizes and windows that do not fit; contrasts in grey levels where a plate has no two triangles that
/// are large enough), those of the observer.
[[nodiscard]] Result<void> check_before_measuring(const MeasurementOptions& options, Observer& observer,
                                                  const SourceInfo& camera);
/// The part of it that needs the plates alone.
[[nodiscard]] Result<void> check_grey_references(const MeasurementOptions& options);

/// A contrast as it is judged by.
struct SeenContrast {
  double contrast_k = 0;                        ///< effective
  double noise_k = 0;                           ///< of a pixel in one frame, as an observer suffers it; 0: not measured
  double levels_per_k = 0;                      ///< signal transfer; 0: the contrast is in kelvin
  GreySteps steps{};                            ///< where it is in grey levels
  std::optional<double> standard_error_k{};     ///< as in Presentation
  std::vector<ReferenceTriangle> references{};  ///< in kelvin; none where the contrast is in grey levels
};

/// One thread at a time. What it is given outlives it.
class SetUpStep {
 public:
  SetUpStep(const MeasurementOptions& options, const FrameSource& camera, FrameTaker& taker,
            std::function<void(const std::string&)> note)
      : options_(options), camera_(camera), taker_(taker), note_(std::move(note)) {}

  /// Takes the frames in which a plate is looked for, and learns the noise from the first that show any.
  [[nodiscard]] Result<AveragedPicture> look(std::stop_token stop);
  /// The plate in the average; `mounted_plate` as `state` says. Errors: those of register_plate(), the opposite
  /// polarity.
  [[nodiscard]] Result<Registration> find(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                          const TargetState& state) const;
  /// What to note where the target says that it shows another contrast than it was told.
  [[nodiscard]] std::optional<std::string> read_back_deviation(const TargetState& set,
                                                               const PresentedTarget& said) const;
  /// Takes the frames of the effective contrast. Errors: those of effective_contrast(), a contrast of the wrong sign.
  [[nodiscard]] Result<SeenContrast> contrast(const TargetPlate& mounted_plate, const Registration& registration,
                                              const TargetState& set, const PresentedTarget& said,
                                              std::stop_token stop);
  /// Of a frame of the set-up whose contrast was measured last: its own grey levels. Errors: those of grey_contrast();
  /// `calibration` where the contrast is less than three of its standard uncertainties.
  [[nodiscard]] Result<GreyFrame> grey_frame(const Frame& frame, const TargetPlate& mounted_plate,
                                             const Registration& registration, const TargetState& set,
                                             const SeenContrast& seen) const;
  /// Pixels of the window at an end of the counts that do not always read so.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const {
    return saturation_.saturated_pixels(frame, window);
  }

  /// Per pixel and frame, from differences of successive frames; 0: not measured.
  [[nodiscard]] double temporal_noise_k() const { return temporal_noise_k_; }
  /// As an observer suffers it: noise that remembers shows only a part of itself in successive frames.
  [[nodiscard]] double noise_of_frame_k() const { return noise_of_frame_k_; }
  [[nodiscard]] std::optional<double> noise_counts() const { return noise_counts_; }
  [[nodiscard]] std::optional<double> lag1_correlation() const { return lag1_correlation_; }

 private:
  [[nodiscard]] bool grey() const { return options_.contrast_unit == ContrastUnit::grey_levels; }
  void keep_noise(const AveragedPicture& picture);
  [[nodiscard]] double response(const std::string& plate) const;
  void note_saturation(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                       const Registration& registration, const TargetState& set, double contrast);
  [[nodiscard]] SeenContrast in_kelvin(const EffectiveContrast& measured, const TargetState& set) const;
  [[nodiscard]] SeenContrast in_grey_levels(const AveragedPicture& picture, const EffectiveContrast& measured,
                                            const TargetState& set, const PresentedTarget& said);

  const MeasurementOptions& options_;
  const FrameSource& camera_;
  FrameTaker& taker_;
  std::function<void(const std::string&)> note_;
  SaturationWatch saturation_;
  double temporal_noise_k_ = 0, noise_of_frame_k_ = 0;
  std::optional<double> noise_counts_, lag1_correlation_;
};

}  // namespace todbench
