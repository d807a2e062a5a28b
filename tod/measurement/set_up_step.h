// SPDX-License-Identifier: GPL-3.0-or-later
// Prepares a set-up: locates the plate, checks the polarity of its triangles and measures the effective contrast. Used
// for plates at rest and for moving plates.
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

/// Checks a measurement before the camera is started. Errors: `calibration` (contrasts in kelvin, but a camera without
/// a temperature scale); `invalid_input` (a geometry that find_misfits() rejects, or contrasts in grey levels and a
/// plate with fewer than two large enough triangles); the errors of the observer.
[[nodiscard]] Result<void> check_before_measuring(const MeasurementOptions& options, Observer& observer,
                                                  const SourceInfo& camera);
/// Performs the part of check_before_measuring() that needs only the plates. Error: `invalid_input`.
[[nodiscard]] Result<void> check_grey_references(const MeasurementOptions& options);

/// Contrast of a set-up, with the noise and the scale that are needed for judging.
struct SeenContrast {
  /// Effective contrast.
  double contrast_k = 0;
  /// Noise of a pixel in one frame, corrected for memory and for the processing stages. 0: not measured.
  double noise_k = 0;
  /// Noise of a pixel in one frame of the camera, before any processing stage.
  double camera_noise_k = 0;
  /// Signal transfer in grey levels per kelvin. 0: the contrast is in kelvin.
  double levels_per_k = 0;
  /// Resolution of the grey levels. Used only if the contrast is in grey levels.
  GreySteps steps{};
  /// Standard error of the contrast. Empty: fewer than two triangles, or a contrast in grey levels.
  std::optional<double> standard_error_k{};
  /// Large triangles with their contrasts in kelvin. Empty if the contrast is in grey levels.
  std::vector<ReferenceTriangle> references{};
  /// Contrast of the smaller triangles (Presentation::small_delta_t_k). Empty: not measured.
  std::optional<double> small_contrast_k{};
  /// Scale of the judged pictures. Empty: no processing stage after the camera.
  std::optional<JudgedScale> judged{};
  /// Fit of the large triangles in the average. Empty: the contrast had not settled, or is in grey levels.
  std::optional<PlaceFit> large{};
};

/// Returns a message for an observed contrast that does not have the sign of the set-point. The message states the
/// reason: the contrast is below one count of the camera (`kelvin_per_count`, if known); the contrast does not exceed
/// three standard errors; or the target or the camera has the wrong sign.
[[nodiscard]] std::string unexpected_sign(double set_k, const EffectiveContrast& observed, ContrastUnit unit,
                                          std::optional<double> kelvin_per_count);

/// Locates plates and measures their effective contrasts. One thread at a time. The arguments of the constructor must
/// outlive the object.
class SetUpStep {
 public:
  /// `note`: called with each note, for example about saturation.
  SetUpStep(const MeasurementOptions& options, const FrameSource& camera, FrameTaker& taker,
            std::function<void(const std::string&)> note)
      : options_(options), camera_(camera), taker_(taker), note_(std::move(note)) {}

  /// Sets whether the contrast of the next averages has settled. If the contrast has not settled, averages are not
  /// compared with earlier pictures.
  void expect(ContrastWait wait) { wait_ = wait; }
  /// Takes the frames in which a plate is located, and returns the average of these frames. Stores the noise of the
  /// first average that has noise.
  [[nodiscard]] Result<AveragedPicture> look(std::stop_token stop);
  /// Locates the plate in the average. Precondition: `mounted_plate` agrees with `state`. Errors: those of
  /// register_plate(); `calibration` (saturated picture, or triangles with the opposite polarity).
  [[nodiscard]] Result<Registration> find(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                                          const TargetState& state) const;
  /// Returns a note if the target reports a contrast that differs from its set-point.
  [[nodiscard]] std::optional<std::string> read_back_deviation(const TargetState& set,
                                                               const PresentedTarget& said) const;
  /// Takes frames and measures the effective contrast in them. Errors: those of effective_contrast(); `calibration`
  /// (wrong sign, a deviation above MeasurementOptions::max_contrast_error, or frames that contradict the scan, see
  /// ScanWatch).
  [[nodiscard]] Result<SeenContrast> contrast(const TargetPlate& mounted_plate, const Registration& registration,
                                              const TargetState& set, const PresentedTarget& said,
                                              std::stop_token stop);
  /// Measures the contrast of a presentation in the frames of this presentation. Returns `seen` with this contrast if
  /// the contrast has the sign of the set-point and exceeds five standard errors; otherwise returns `seen` unchanged.
  /// Errors: those of effective_contrast(); `calibration` (pixels without a temperature).
  [[nodiscard]] Result<SeenContrast> own_contrast(std::span<const Frame> frames, const TargetPlate& mounted_plate,
                                                  const Registration& registration, const TargetState& set,
                                                  SeenContrast seen) const;
  /// Measures the contrast of one frame in grey levels. Precondition: the contrast of this set-up was measured last.
  /// Errors: those of grey_contrast(); `calibration` if the contrast is below three times its standard uncertainty.
  [[nodiscard]] Result<GreyFrame> grey_frame(const Frame& frame, const TargetPlate& mounted_plate,
                                             const Registration& registration, const TargetState& set,
                                             const SeenContrast& seen) const;
  /// Returns the gain of the judged frame: kelvin in this frame per kelvin in the camera's frames. 1 without
  /// processing. Precondition: the contrast of this set-up was measured last. Errors: those of judged_gain().
  [[nodiscard]] Result<double> gain_of(const Frame& frame, const TargetPlate& mounted_plate,
                                       const Registration& registration, const SeenContrast& seen) const;
  /// Returns the number of pixels in the window at the lowest or the highest count, without defective pixels.
  [[nodiscard]] int saturated_pixels(const Frame& frame, const cv::Rect& window) const {
    return saturation_.saturated_pixels(frame, window);
  }
  /// Returns the number of samples of the judged picture in the window at the lowest or the highest count. The range of
  /// counts after the processing stages may differ from that of the camera.
  [[nodiscard]] int saturated_samples(const Frame& frame, const cv::Rect& window) const;

  /// Returns the temporal noise per pixel and frame, from differences of successive frames; 0: not measured.
  [[nodiscard]] double temporal_noise_k() const { return temporal_noise_k_; }
  /// Returns the temporal noise in steps of the counts, near the surround; empty: not measured.
  [[nodiscard]] std::optional<double> noise_counts() const { return noise_counts_; }
  /// Returns the lag-1 correlation of the noise; empty: too few frames.
  [[nodiscard]] std::optional<double> lag1_correlation() const { return lag1_correlation_; }

  /// Returns the data for the constancy tests, from the averages taken so far.
  [[nodiscard]] const RunConstancy& constancy() const { return constancy_; }

 private:
  /// Takes an average and compares it with the previous average.
  [[nodiscard]] Result<AveragedPicture> average(int count, std::stop_token stop,
                                                const FrameTaker::EachFrame& each = {});
  [[nodiscard]] bool grey() const { return options_.contrast_unit == ContrastUnit::grey_levels; }
  void keep_noise(const AveragedPicture& picture);
  [[nodiscard]] double response(const std::string& plate) const;
  void note_saturation(const AveragedPicture& picture, const TargetPlate& mounted_plate,
                       const Registration& registration, const TargetState& set, double contrast);
  /// Determines the lowest and the highest count of the judged pictures, and adds a note about saturation. `contrast`:
  /// contrast after the processing stages.
  void note_saturation_behind(const JudgedFrames& frames, const TargetPlate& mounted_plate, const TargetState& set,
                              double contrast);
  [[nodiscard]] Result<SeenContrast> in_kelvin(const EffectiveContrast& measured, const TargetState& set) const;
  [[nodiscard]] Result<void> check_contrast(double seen_k, double error_k, const TargetState& set) const;
  [[nodiscard]] SeenContrast in_grey_levels(const AveragedPicture& picture, const EffectiveContrast& measured,
                                            const TargetState& set, const PresentedTarget& said);

  /// Keeps the residue with the largest ratio of share to limit.
  void keep_residue(const std::optional<PictureResidue>& residue);
  /// Adjusts `seen` for the processing stages after the camera.
  void judge_by(const std::optional<JudgedScale>& judged, const TargetState& set, SeenContrast& seen);

  const MeasurementOptions& options_;
  const FrameSource& camera_;
  FrameTaker& taker_;
  std::function<void(const std::string&)> note_;
  SaturationWatch saturation_, saturation_behind_;
  /// Response by plate. It replaces MeasurementOptions::contrast_response.
  std::map<std::string, double> learnt_response_;
  double temporal_noise_k_ = 0;
  /// Noise of a pixel in one frame. If the noise has memory, this value exceeds temporal_noise_k_, because differences
  /// of successive frames contain only a part of the noise.
  double noise_of_frame_k_ = 0;
  double memory_ratio_ = 1;              ///< JudgedMemory::ratio()
  std::vector<double> noted_contrasts_;  ///< set contrasts for which a note about processing stages was added
  std::optional<double> noise_counts_, lag1_correlation_;
  ContrastWait wait_ = ContrastWait::settled;
  cv::Mat1d before_;         ///< mean of the last average; empty: no average yet
  cv::Mat1d judged_before_;  ///< mean of the judged pictures of the last average; empty: not processed
  RunConstancy constancy_;
  ScanWatch scan_;
};

}  // namespace todbench
