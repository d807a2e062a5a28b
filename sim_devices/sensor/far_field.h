// What the parts of a huge shape that are far away add to a sample: the tail of the diffraction spot, integrated.
#pragma once

#include "hvs/shape/polygon.h"

namespace todbench {

/// The part of a shape within the square |x|, |y| <= half_width (Sutherland and Hodgman 1974). Parts of a concave shape
/// that the square separates stay joined along its edge, which encloses nothing.
[[nodiscard]] Polygon clipped(const Polygon& shape, double half_width);

/// The integral of |y - from|^-3 over the part of the shape outside that square; `from` lies inside it. By rays from
/// `from`: each adds 1/r where it enters the shape and takes 1/r where it leaves. Relative error 1e-5. Unit 1/length.
[[nodiscard]] double far_integral(const Polygon& shape, cv::Point2d from, double half_width);

}  // namespace todbench
