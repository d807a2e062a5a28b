// SPDX-License-Identifier: GPL-3.0-or-later
// Separates the fixed pattern of a camera and the unevenness of the source by shifting the source (data reference
// method).
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "acquisition/base/result.h"

namespace todbench {

/// A mean picture with the source shifted by whole pixels, x right, y down.
struct ShiftedPicture {
  cv::Point shift_px{0, 0};
  cv::Mat1d picture;
};

/// Model: picture = camera(x) + source(x - shift) + level of the picture. If a linear slope is shifted, only the level
/// changes. A slope can therefore not be assigned to the camera or to the source. The slope is removed from both
/// patterns and stated separately.
struct SeparatedPattern {
  cv::Mat1d camera;  ///< mean 0, without slope
  cv::Mat1d source;  ///< larger than a picture by the span of the shifts; mean 0, without slope
  /// Slope of the mean picture per pixel along x and y. It is the sum of the slopes of camera and source.
  cv::Point2d slope_per_px{0, 0};
  double residual = 0;  ///< root mean square of the residuals
};

/// Separates camera and source by least squares with conjugate gradients. Errors: `invalid_input` (fewer than three
/// pictures, different sizes, a value that is not finite, shifts that do not span both axes, or shifts with a common
/// divisor, which do not determine periodic patterns).
[[nodiscard]] Result<SeparatedPattern> separated_pattern(std::span<const ShiftedPicture> pictures);

}  // namespace todbench
