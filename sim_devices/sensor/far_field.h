// SPDX-License-Identifier: GPL-3.0-or-later
// Contribution of the distant parts of a huge shape to a sample: the integrated tail of the diffraction spot.
#pragma once

#include "hvs/shape/polygon.h"

namespace todbench {

/// Returns the part of a shape within the square |x|, |y| <= half_width (Sutherland and Hodgman 1974). If the square
/// cuts a concave shape into several parts, lines along the edge of the square join the parts; they enclose no area.
[[nodiscard]] Polygon clipped(const Polygon& shape, double half_width);

/// Returns the integral of |y - from|^-3 over the points y of the shape outside the square |x|, |y| <= half_width, in
/// 1/length; relative error 1e-5. `from` lies in the square. Each ray from `from` adds 1/r at the distance r where the
/// ray enters the shape, and subtracts 1/r where the ray leaves the shape.
[[nodiscard]] double far_integral(const Polygon& shape, cv::Point2d from, double half_width);

}  // namespace todbench
