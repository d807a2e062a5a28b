// SPDX-License-Identifier: GPL-3.0-or-later
// Preparation of a set-up with a plate at rest or in motion: location of the plate, polarity of its triangles,
// effective contrast. Both kinds of measurement share these checks and messages.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/grey_levels.h"
#include "tod/measurement/judged_contrast.h"
#include "tod/measurement/measurement.h"
#include "tod/measurement/run_constancy.h"
#include "tod/measurement/saturation_watch.h"
#include "tod/measurement/scan_watch.h"
#include "tod/presentation/target.h"
#include "tod/registration/registration.h"
#include "tod/registration/shift_fit.h"

namespace todbench {

/// Returns the options of the frame taker. For contrasts in grey levels, frames contain counts instead of kelvin.
[[nodiscard]] FrameTakerOptions taker_options(const MeasurementOptions& options, const SourceInfo& camera,
                                              std::function<void(const RejectedFrame&)> on_rejected = {});

/// Checks a measurement before the camera is started. Errors: `calibration` (counts without temperature for contrasts
/// in kelvin), `invalid_input` (sizes or windows that do not fit; contrasts in grey levels with a plate that has fewer
/// than two large enough triangles), those of the observer.
[[nodiscard]] Result<void> check_before_measuring(const MeasurementOptions& options, Observer& observer,
                                                  const SourceInfo& camera);
/// Performs the part of check_before_measuring() that needs only the plates.
[[nodiscard]] Result<void> check_grey_references(const MeasurementOptions& options);

/// A contrast in the form that is used for judging.
struct SeenContrast {
  double contrast_k = 0;      ///< effective
  double noise_k = 0;         ///< noise of a pixel in one frame, as it affects an observer; 0: not measured
  double camera_noise_k = 0;  ///< the same for the camera's own frames, before any stage
  double levels_per_k = 0;    ///< signal transfer; 0: the contrast is in kelvin
  GreySteps steps{};          ///< filled if the contrast is in grey levels
  std::optional<double> standard_error_k{};     ///< as in Presentation
  std::vector<ReferenceTriangle> references{};  ///< in kelvin; empty if the contrast is in grey levels
  std::optional<double> small_contrast_k{};     ///< as Presentation::small_delta_t_k
  std::optional<JudgedScale> judged{};          ///< empty: no stage after the camera
  std::optional<PlaceFit> large{};  ///< fit of the large triangles in the average; empty: contrast not settled, or in
                                    ///< grey levels
};

/// Returns the reason why a contrast was observed without the sign of its set-point. It is below one count of the
/// camera (`kelvin_per_count`, if known), it does not exceed the noise (three standard errors), or one of the signs is
/// wrong.
[[nodiscard]] std::string unexpected_sign(double set_k, const EffectiveContrast& observed, ContrastUnit unit,
                                          std::optional<double> kelvin_per_count);

/// Locates plates and measures their effective contrasts. One thread at a time. The arguments must outlive it.
class SetUpStep {
 public:
  SetUpStep(const MeasurementOptions& options, const FrameSource& camera, FrameTaker& taker,
            std::function<void(const std::string&)> note)
      : options_(options), camera_(camera), taker_(taker), note_(std::move(note)) {}

  /// States whether the contrast of the next averages has settled. If not, they are not compared with earlier pictures.
  void expect(ContrastWait wait) { wait_ = wait; }
  /// Takes the frames in which a plate is located, and learns the noise from the first frames that show any.
  [[nodiscard]] Result<AveragedPicture> look(std::stop_token stop);
  /// Locates the plate in the average. `mounted_plate` agrees with `state`. Errors: those of register_plate(), opposite
  /// polarity.
  [[nodiscard]] Result<Registration> find(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                          const TargetState& state) const;
  /// Returns a note if the target reports a contrast that differs from its set-point.
  [[nodiscard]] std::optional<std::string> read_back_deviation(const TargetState& set,
                                                               const PresentedTarget& said) const;
  /// Takes the frames of the effective contrast. Errors: those of effective_contrast(); `calibration` (wrong sign,
  /// beyond MeasurementOptions::max_contrast_error, or frames that contradict the scan, see ScanWatch).
  [[nodiscard]] Result<SeenContrast> contrast(const TargetPlate& mounted_plate, const Registration& registration,
                                              const TargetState& set, const PresentedTarget& said,
                                              std::stop_token stop);
  /// Measures the contrast of a presentation in its own frames. It replaces the contrast of `seen` if it exceeds its
  /// noise. Errors: those of effective_contrast(); `calibration` (pixels without a temperature).
  [[nodiscard]] Result<SeenContrast> own_contrast(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                                  const Registration& registration, const TargetState& set,
                                                  SeenContrast seen) const;
  /// Measures the grey levels of one frame of the set-up whose contrast was measured last. Errors: those of
  /// grey_contrast(); `calibration` if the contrast is less than three of its standard uncertainties.
  [[nodiscard]] Result<GreyFrame> grey_frame(const Frame& frame, const TargetPlate& mounted_plate,
                                             const Registration& registration, const TargetState& set,
                                             const SeenContrast& seen) const;
  /// Returns the kelvin of the judged frame per kelvin of the set-up whose contrast was measured last. Errors: those of
  /// judged_gain().
  [[nodiscard]] Result<double> gain_of(const Frame& frame, const TargetPlate& mounted_plate,
                                       const Registration& registration, const SeenContrast& seen) const;
  /// Returns the number of pixels of the window at an end of the counts, without the defective ones.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const {
    return saturation_.saturated_pixels(frame, window);
  }
  /// Same for samples of the judged picture, whose range of counts may differ from that of the camera.
  [[nodiscard]] int saturated_samples(const Frame& frame, const cv::Rect& window) const;

  /// Returns the temporal noise per pixel and frame, from differences of successive frames; 0: not measured.
  [[nodiscard]] double temporal_noise_k() const { return temporal_noise_k_; }
  [[nodiscard]] std::optional<double> noise_counts() const { return noise_counts_; }
  [[nodiscard]] std::optional<double> lag1_correlation() const { return lag1_correlation_; }

  /// Returns results that show whether the camera remained constant, from the averages so far.
  [[nodiscard]] const RunConstancy& constancy() const { return constancy_; }

 private:
  /// Takes an average and compares it with the previous one.
  [[nodiscard]] Result<AveragedPicture> average(int count, std::stop_token stop,
                                                const FrameTaker::EachFrame& each = {});
  [[nodiscard]] bool grey() const { return options_.contrast_unit == ContrastUnit::grey_levels; }
  void keep_noise(const AveragedPicture& picture);
  [[nodiscard]] double response(const std::string& plate) const;
  void note_saturation(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                       const Registration& registration, const TargetState& set, double contrast);
  /// Learns the ends of the counts in the stages' pictures. `contrast`: contrast after the stages.
  void note_saturation_behind(const JudgedFrames& frames, const TargetPlate& mounted_plate, const TargetState& set,
                              double contrast);
  [[nodiscard]] Result<SeenContrast> in_kelvin(const EffectiveContrast& measured, const TargetState& set) const;
  [[nodiscard]] Result<void> check_contrast(double seen_k, double error_k, const TargetState& set) const;
  [[nodiscard]] SeenContrast in_grey_levels(const AveragedPicture& picture, const EffectiveContrast& measured,
                                            const TargetState& set, const PresentedTarget& said);

  /// Keeps the residue that is largest relative to its limit.
  void keep_residue(const std::optional<PictureResidue>& residue);
  /// Adjusts `seen` for the stages after the camera.
  void judge_by(const std::optional<JudgedScale>& judged, const TargetState& set, SeenContrast& seen);

  const MeasurementOptions& options_;
  const FrameSource& camera_;
  FrameTaker& taker_;
  std::function<void(const std::string&)> note_;
  SaturationWatch saturation_, saturation_behind_;
  std::map<std::string, double> learnt_response_;  ///< by plate; replaces the response of the options
  double temporal_noise_k_ = 0;
  /// Noise as it affects an observer; successive frames contain only a part of noise with memory.
  double noise_of_frame_k_ = 0;
  double memory_ratio_ = 1;              ///< JudgedMemory::ratio()
  std::vector<double> noted_contrasts_;  ///< contrasts after the stages
  std::optional<double> noise_counts_, lag1_correlation_;
  ContrastWait wait_ = ContrastWait::settled;
  cv::Mat1d before_;         ///< mean of the last average; empty: none yet
  cv::Mat1d judged_before_;  ///< the same of the judged pictures; empty: no stage changed them
  RunConstancy constancy_;
  ScanWatch scan_;
};

}  // namespace todbench
