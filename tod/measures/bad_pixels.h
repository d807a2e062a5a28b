// Pixels that do not answer like the others: which, why, and how they stand together.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/core/result.h"

namespace todbench {

/// From where on a pixel is bad. Common rules, not laws: an acceptance states its own.
struct BadPixelRules {
  double dead_responsivity = 0.25;  ///< |responsivity / median - 1| above this
  double noisy = 3;                 ///< temporal standard deviation above so many medians
  double offset = 5;                ///< |offset - median| above so many 1.4826 x median deviations
};

/// What is known of each pixel. A picture that is empty was not measured, and its rule finds nothing.
struct PixelProperties {
  cv::Mat1d responsivity{};  ///< signal per kelvin
  cv::Mat1d offset{};        ///< mean signal before a flat field
  cv::Mat1d noise_sd{};      ///< temporal
};

struct BadPixels {
  cv::Mat1b dead, noisy, offset;  ///< 255 where the rule holds
  cv::Mat1b bad;                  ///< any of them
  int count = 0;
  int clusters = 0;         ///< of two pixels or more that touch, diagonally too
  int largest_cluster = 0;  ///< pixels; 1 where none touch, 0 without bad pixels
  double operability_percent = 100;
};

/// `invalid_input`: nothing measured, pictures of different sizes, a value that is not finite, or a median that leaves
/// a rule without a scale.
[[nodiscard]] Result<BadPixels> bad_pixels(const PixelProperties& pixels, const BadPixelRules& rules);

}  // namespace todbench
