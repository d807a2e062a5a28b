// SPDX-License-Identifier: GPL-3.0-or-later
// Contrast and noise of pictures that processing stages made of a camera's frames. Stages may change the scale; an
// observer judges relative to the contrast, so the contrast of the judged picture decides, not that of the camera.
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

/// Scale of the judged pictures of one set-up and contrast, relative to that of the camera.
struct JudgedScale {
  double gain = 1;          ///< contrast of the large triangles over that in the camera's frames; negative: inverted
  double gain_error = 0;    ///< standard error, from the scatter over the triangles
  double camera_level = 0;  ///< contrast of the large triangles in the camera's frames, on its scale
  double noise_ratio = 1;   ///< noise of a judged frame over that of a camera's frame, each on its own scale
  bool changes = false;     ///< the gain changes from frame to frame and is measured for each
  GreySteps steps{};        ///< of the judged counts
};
/// Record of a set-up and contrast.
struct JudgedContrast {
  std::string plate;
  Mounting mounting = Mounting::identity;
  double set_delta_t_k = 0;
  double delta_t_k = 0;         ///< before the stages, as reported
  double judged_delta_t_k = 0;  ///< after the stages, on the camera's scale
  double noise_k = 0;           ///< as passed to the observer, referred to the contrast before the stages
  JudgedScale scale{};
};

/// Whether any stage changed the frame.
[[nodiscard]] bool behind_stages(const Frame& frame);

/// Contrast of the large triangles of one judged frame by means, on the scale of its counts. If the judged picture is
/// finer than the camera's, only every samples_per_pixel-th sample is used. Errors: those of effective_contrast() and
/// of the scale.
[[nodiscard]] Result<EffectiveContrast> judged_levels(const Frame& frame, const TargetPlate& mounted_plate,
                                                      const Registration& registration, double min_size_px);

/// Memory of the noise after the stages relative to that of the camera, from successive frames of one scene.
class JudgedMemory {
 public:
  explicit JudgedMemory(int frames) : camera_(frames, FrameGain::changing), judged_(frames, FrameGain::changing) {}
  /// Ignores frames without a judged picture and frames that are the camera's own.
  void add(const Frame& frame);
  /// LagDifferences::memory() of the judged frames over that of the camera's; 1 without stages.
  [[nodiscard]] double ratio() const;

 private:
  LagDifferences camera_, judged_;
};

/// Collects the frames from which the contrast of a set-up is measured. The arguments must outlive it.
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
  /// Average of the judged frames, on the camera's scale, and the registration in it. Empty without stages, or if the
  /// stages' pictures are finer.
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
  std::vector<std::vector<double>> camera_, judged_;  ///< by frame and triangle
  cv::Mat1w lowest_, highest_;
  cv::Mat1d kelvin_sum_;
  cv::Point2d first_px_ = {0, 0};
  int samples_per_pixel_ = 1, significant_bits_ = 16;
  double kelvin_per_count_ = 1;
  std::optional<Error> error_;
};

/// Returns the gain of one frame, for stages whose gain changes from frame to frame. Errors: `not_identifiable` if it
/// is less than three standard errors from 0.
[[nodiscard]] Result<double> judged_gain(const Frame& frame, const TargetPlate& mounted_plate,
                                         const Registration& registration, double min_size_px,
                                         const JudgedScale& scale);

/// Number of judged samples of the window that were clipped at an end of the counts.
[[nodiscard]] int cut_off_samples(const Frame& frame, const cv::Rect& window);

}  // namespace todbench
