// SPDX-License-Identifier: GPL-3.0-or-later
// Flat shapes of uniform contrast: targets of the sensor and shapes of the observer's templates.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace todbench {

/// Vertices in order, clockwise or counter-clockwise, without self-intersection. x right, y down; the unit is the
/// caller's.
using Polygon = std::vector<cv::Point2d>;

/// Returns the enclosed area, never negative.
[[nodiscard]] double area(const Polygon& polygon);
/// Returns the centroid of the area.
[[nodiscard]] cv::Point2d centroid(const Polygon& polygon);
/// Returns the polygon scaled about the origin, then moved.
[[nodiscard]] Polygon placed(const Polygon& polygon, double scale, cv::Point2d offset);

}  // namespace todbench
