// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon with a Gaussian blur, at pixel centres: the shape that registration fits to the picture.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/shape/polygon.h"

namespace todbench {

/// Picture of a polygon of contrast 1 in a window, and derivatives of the picture: change per pixel of shift.
struct BlurredPolygon {
  cv::Mat1d value, d_shift_x, d_shift_y;
};

/// Returns the polygon (in pixels) convolved with a Gaussian of standard deviation `blur_px` > 0, at the pixel centres
/// of `window`. The error of `value` is below 5e-6. For locating a triangle, a Gaussian is a sufficient model of the
/// blur by optics, detector and sampling, because to first order only the variance of the blur matters.
[[nodiscard]] BlurredPolygon blurred_polygon(const Polygon& polygon, double blur_px, cv::Rect window);

}  // namespace todbench
