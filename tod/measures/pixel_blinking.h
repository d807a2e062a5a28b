// Pixels that sit on two levels in time, or on another level for a while.
#pragma once

#include <opencv2/core.hpp>

namespace todbench {

struct BlinkingRules {
  double medians = 3;   ///< of the largest change of level over all pixels
  double levels = 4.5;  ///< standard deviations between two levels
  double noise_sd = 0;  ///< of the median pixel, in the unit of the series
};

/// `series`: pixels of a picture of `size` in rows, in reading order, frames in columns, means of 0. 255 where a pixel
/// blinks. Precondition: at least 16 frames.
[[nodiscard]] cv::Mat1b blinking_pixels(const cv::Mat1f& series, cv::Size size, const BlinkingRules& rules);

}  // namespace todbench
