// SPDX-License-Identifier: GPL-3.0-or-later
// Detects pixels that switch between two levels, or stay on a different level for some time.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Limits of a pixel's largest change of level. A pixel that exceeds any of these limits blinks.
struct BlinkingRules {
  /// Limit of the largest change divided by the pixel's noise, as a multiple of the median over the pixels.
  double medians = 3;
  double levels = 4.5;  ///< limit of the distance between two levels, in standard deviations
  double noise_sd = 0;  ///< noise of the median pixel, in the unit of the series
};

/// Returns 255 for each blinking pixel. `series`: one row for each pixel of a picture of `size`, in reading order, and
/// one column for each frame; the mean of each row is 0. Precondition: at least 16 frames.
[[nodiscard]] cv::Mat1b blinking_pixels(const cv::Mat1f& series, cv::Size size, const BlinkingRules& rules);

}  // namespace todbench
