// SPDX-License-Identifier: GPL-3.0-or-later
// Triangles on a calibrated display, without camera and sensor, for a person: without noise, or in white noise. The
// answers determine the open parameters of an observer with an eye.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "acquisition/base/result.h"
#include "hvs/observer/template_observer.h"
#include "tod/plate/test_pattern.h"

namespace todbench {

/// Experiment for one person.
struct NakedEyeTask {
  TemplateObserverSpec model;  ///< observer with an eye, and with the calibrated display of the person
  /// Luminance contrasts: target minus background over background, above 0. Targets are brighter than the background.
  std::vector<double> contrasts{0.4, 0.15, 0.06};
  double noise = 0;   ///< standard deviation of white noise per displayed sample, as a luminance contrast
  int per_size = 12;  ///< triangles per contrast and size
  std::uint64_t seed = 1;
  bool operator==(const NakedEyeTask&) const = default;
};

/// Checks a task. Errors: `invalid_input` (no eye, no display, a contrast or noise that the display cannot show).
[[nodiscard]] Result<void> validate(const NakedEyeTask& task);

/// Returns a display whose luminance is proportional to the level and on which 1 K is a luminance contrast of 1. The
/// display describes the picture that the person sees, because pictures are drawn with the measured luminances of the
/// levels. Precondition: validate() of the display succeeds.
[[nodiscard]] ViewedDisplay linear_display(const ViewedDisplay& display);

/// Returns the model that looks at this display. Precondition: validate() of the task succeeds.
[[nodiscard]] TemplateObserverSpec model_at_linear_display(const NakedEyeTask& task);
/// Returns the angle of a displayed sample at the eye, in mrad.
[[nodiscard]] double mrad_per_sample(const ViewedDisplay& display);

/// Number of sizes at each contrast, and ratio of neighbouring sizes. The fourth size is near the predicted threshold.
inline constexpr int naked_eye_sizes = 8;
inline constexpr double naked_eye_size_ratio = 1.22;

/// One triangle.
struct NakedEyeTrial {
  double contrast = 0;
  double size_samples = 0;  ///< square root of area, in displayed samples
  Apex truth = Apex::up;
  cv::Point2d centroid{};  ///< from the middle of the picture, in displayed samples, within half a sample
  std::uint64_t number = 0;
};

/// Picture as the display shows it.
struct NakedEyePicture {
  cv::Mat1b levels;    ///< one per displayed sample
  cv::Mat1f contrast;  ///< luminance contrast of every sample against the background, from its level
  /// Standard deviation per sample: the noise of the task combined with the noise of rounding to levels.
  double noise = 0;
};

/// Draws a square picture of `window_samples` on a side. The luminance of a sample follows from the share of its area
/// that the triangle covers. The luminance is rounded up or down at random to one of 256 levels. The mean level then
/// represents the luminance, so that contrasts far below one level can be shown. Noise and rounding follow from the
/// seed of the task and the number of the trial.
[[nodiscard]] NakedEyePicture naked_eye_picture(const NakedEyeTask& task, const NakedEyeTrial& trial,
                                                int window_samples);

/// Returns the trials of every contrast and size, with each direction equally often, in random order. `sizes_samples`:
/// sizes in displayed samples for each contrast.
[[nodiscard]] std::vector<NakedEyeTrial> naked_eye_trials(const NakedEyeTask& task,
                                                          const std::vector<std::vector<double>>& sizes_samples);

}  // namespace todbench
