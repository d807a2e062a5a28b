// A polygon seen through a Gaussian blur, at pixel centres: the shape that registration fits to the picture.
#pragma once

#include <opencv2/core.hpp>

#include "hvs/shape/polygon.h"

namespace todbench {

/// The picture of a polygon of contrast 1 in a window, and how it changes when the polygon moves by 1 px.
struct BlurredPolygon {
  cv::Mat1d value, d_shift_x, d_shift_y;
};

/// The polygon (pixels) convolved with a Gaussian of standard deviation `blur_px` > 0 at the pixel centres of `window`;
/// error of `value` below 1e-4. Optics, detector and the sampling box together are near enough to a Gaussian for
/// locating a triangle: of their shape only the variance matters to first order.
[[nodiscard]] BlurredPolygon blurred_polygon(const Polygon& polygon, double blur_px, cv::Rect window);

}  // namespace todbench
