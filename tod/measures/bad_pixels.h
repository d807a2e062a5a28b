// SPDX-License-Identifier: GPL-3.0-or-later
// Bad pixels of a picture: rules, reasons and clusters.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/base/result.h"

namespace todbench {

/// Limits of bad pixels. They are common rules, not a standard; an acceptance test states its own limits.
struct BadPixelRules {
  double dead_responsivity = 0.25;  ///< |responsivity / median - 1| above this
  double noisy = 3;                 ///< temporal standard deviation above this multiple of the median
  double offset = 5;                ///< |offset - median| above this multiple of 1.4826 x median deviation
};

/// Measured properties of each pixel. An empty picture means not measured; its rule finds no pixels.
struct PixelProperties {
  cv::Mat1d responsivity{};  ///< signal per kelvin
  cv::Mat1d offset{};        ///< mean signal of a flat field
  cv::Mat1d noise_sd{};      ///< temporal standard deviation
};

/// Bad pixels by rule, and their clusters.
struct BadPixels {
  cv::Mat1b dead, noisy, offset;  ///< 255 if the rule holds
  cv::Mat1b bad;                  ///< any of the three
  int count = 0;
  int clusters = 0;         ///< clusters of at least two pixels that touch, also diagonally
  int largest_cluster = 0;  ///< in pixels; 1 if none touch, 0 without bad pixels
  double operability_percent = 100;
};

/// Finds bad pixels. Errors: `invalid_input` (no picture, pictures of different sizes, a value that is not finite, or a
/// median of 0 that a rule needs as its scale).
[[nodiscard]] Result<BadPixels> bad_pixels(const PixelProperties& pixels, const BadPixelRules& rules);

}  // namespace todbench
