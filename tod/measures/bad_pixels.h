// SPDX-License-Identifier: GPL-3.0-or-later
// Bad pixels of a picture: rules, reasons and clusters.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/base/result.h"

namespace todbench {

/// Limits above which a pixel is bad. The defaults are common rules, not a standard. An acceptance test must state the
/// limits explicitly.
struct BadPixelRules {
  double dead_responsivity = 0.25;  ///< limit of |responsivity / median - 1|
  bool strong_responsivity = true;  ///< true: the limit applies on both sides of the median; false: only below it
  double noisy = 3;                 ///< limit of the temporal standard deviation, as a multiple of the median
  double offset = 5;                ///< limit of |offset - median|, as a multiple of 1.4826 x median deviation
};

/// Measured properties of each pixel. Empty picture: the property was not measured, and its rule finds no pixels.
struct PixelProperties {
  cv::Mat1d responsivity{};  ///< signal per kelvin
  cv::Mat1d offset{};        ///< mean signal of a flat field
  cv::Mat1d noise_sd{};      ///< temporal standard deviation
};

/// Bad pixels by rule, and their clusters.
struct BadPixels {
  cv::Mat1b dead, noisy, offset;  ///< 255 if the pixel exceeds the limit
  cv::Mat1b bad;                  ///< exceeds any of the three limits
  int count = 0;
  int clusters = 0;         ///< number of clusters of at least two touching pixels, also diagonally
  int largest_cluster = 0;  ///< number of pixels; 1 if no bad pixels touch, 0 without bad pixels
  double operability_percent = 100;
};

/// Returns whether the responsivity of a pixel, relative to the median, is bad. False for NaN.
[[nodiscard]] bool responds_badly(double relative_responsivity, const BadPixelRules& rules);

/// Finds bad pixels. Errors: `invalid_input` (no picture, pictures of different sizes, a value that is not finite, or a
/// median of 0 although a rule divides by the median).
[[nodiscard]] Result<BadPixels> bad_pixels(const PixelProperties& pixels, const BadPixelRules& rules);

}  // namespace todbench
