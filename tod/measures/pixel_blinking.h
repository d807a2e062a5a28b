// SPDX-License-Identifier: GPL-3.0-or-later
// Detects pixels that switch between two levels, or stay on another level for some time.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

/// Limits of a pixel's largest change of level; a pixel that exceeds one of them blinks.
struct BlinkingRules {
  double medians = 3;   ///< in units of the pixel's noise, as a multiple of the median over pixels
  double levels = 4.5;  ///< distance between two levels, in standard deviations
  double noise_sd = 0;  ///< noise of the median pixel, in the unit of the series
};

/// Returns 255 for each blinking pixel. `series`: the pixels of a picture of `size` as rows, in reading order; frames
/// as columns; means of 0. Precondition: at least 16 frames.
[[nodiscard]] cv::Mat1b blinking_pixels(const cv::Mat1f& series, cv::Size size, const BlinkingRules& rules);

}  // namespace todbench
