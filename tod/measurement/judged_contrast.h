// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast and noise of the pictures that processing stages compute from the frames of a camera. Processing stages may
// change the scale. The observer judges relative to the contrast, so the contrast of the judged picture must be used
// instead of that of the camera's frame.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/core/frame.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measurement/grey_levels.h"
#include "tod/measurement/lag_differences.h"
#include "tod/plate/target_plate.h"
#include "tod/registration/registration.h"

namespace todbench {

/// Scale of the judged pictures of one set-up and contrast, relative to the scale of the camera.
struct JudgedScale {
  /// Contrast of the large triangles in the judged pictures divided by their contrast in the camera's frames. Negative:
  /// the stages invert the contrast.
  double gain = 1;
  double gain_error = 0;    ///< standard error, from the scatter over the triangles
  double camera_level = 0;  ///< contrast of the large triangles in the camera's frames, on the camera's scale
  double noise_ratio = 1;   ///< noise of a judged frame, on its scale, divided by the noise of a camera's frame, on the
                            ///< camera's scale
  bool changes = false;     ///< true: the gain changes from frame to frame and is measured in each frame
  GreySteps steps{};        ///< resolution of the judged counts
};
/// Record of one set-up and contrast.
struct JudgedContrast {
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0;
  double delta_t_k = 0;         ///< before the processing stages, reported by the target
  double judged_delta_t_k = 0;  ///< after the processing stages, on the camera's scale
  double noise_k = 0;           ///< noise passed to the observer, converted to kelvin before the stages
  JudgedScale scale{};
};

/// Returns whether any processing stage changed the frame.
[[nodiscard]] bool behind_stages(const Frame& frame);

/// Returns the contrast of the large triangles in one judged frame, computed from mean levels, on the scale of the
/// judged counts. If the judged picture has several samples per pixel of the camera, only one sample per pixel is used.
/// Errors: those of effective_contrast() and of the scale.
[[nodiscard]] Result<EffectiveContrast> judged_levels(const Frame& frame, const TargetPlate& mounted_plate,
                                                      const Registration& registration, double min_size_px);

/// Ratio of the memory of the noise after the stages to the memory of the camera's noise. Computed by
/// LagDifferences::memory() from successive frames of one scene.
class JudgedMemory {
 public:
  explicit JudgedMemory(int frames) : camera_(frames, FrameGain::changing), judged_(frames, FrameGain::changing) {}
  /// Adds a frame. Ignores frames without a judged picture and frames that no stage changed.
  void add(const Frame& frame);
  /// Returns LagDifferences::memory() of the judged frames divided by that of the camera's frames; 1 without stages.
  [[nodiscard]] double ratio() const;

 private:
  LagDifferences camera_, judged_;
};

/// Collects the frames in which the contrast of a set-up is measured. The arguments of the constructor must outlive the
/// object.
class JudgedFrames {
 public:
  JudgedFrames(const TargetPlate& mounted_plate, const Registration& registration, double min_size_px, int frames)
      : plate_(mounted_plate),
        registration_(registration),
        min_size_px_(min_size_px),
        camera_noise_(frames, FrameGain::changing),
        judged_noise_(frames, FrameGain::changing) {}

  void add(const Frame& frame);
  /// Returns the scale of the judged pictures; empty without stages. `memory_ratio`: JudgedMemory::ratio(). Errors:
  /// those of judged_levels(); `not_identifiable` (the judged pictures do not show the large triangles).
  [[nodiscard]] Result<std::optional<JudgedScale>> scale(double memory_ratio) const;
  /// Average of the judged frames on the camera's scale, and registration in this average. Empty without stages, or if
  /// the judged pictures have more samples than the camera's frames.
  struct Average {
    AveragedPicture picture;
    Registration registration;
  };
  [[nodiscard]] std::optional<Average> average() const;

 private:
  [[nodiscard]] Result<void> take(const Frame& frame);

  const TargetPlate& plate_;
  const Registration& registration_;
  double min_size_px_;
  LagDifferences camera_noise_, judged_noise_;
  std::vector<std::vector<double>> camera_, judged_;  ///< contrast of each triangle in each frame
  cv::Mat1w lowest_, highest_;
  cv::Mat1d kelvin_sum_;
  cv::Point2d first_px_ = {0, 0};
  int samples_per_pixel_ = 1, significant_bits_ = 16;
  double kelvin_per_count_ = 1;
  std::optional<Error> error_;
};

/// Returns the gain of one frame, for stages whose gain changes from frame to frame. Error: `not_identifiable` if the
/// gain is less than three standard errors from 0.
[[nodiscard]] Result<double> judged_gain(const Frame& frame, const TargetPlate& mounted_plate,
                                         const Registration& registration, double min_size_px,
                                         const JudgedScale& scale);

/// Returns the number of judged samples in the window that were clipped at the lowest or the highest count.
[[nodiscard]] int cut_off_samples(const Frame& frame, const cv::Rect& window);

}  // namespace todbench
