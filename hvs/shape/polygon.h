// Flat shapes of uniform contrast: what the sensor looks at and what the observer has in mind.
#pragma once

#include <opencv2/core/types.hpp>
#include <vector>

namespace todbench {

/// Vertices in order, either sense of rotation, not self-intersecting. x right, y down; the unit is the caller's.
using Polygon = std::vector<cv::Point2d>;

/// Enclosed area, never negative.
[[nodiscard]] double area(const Polygon& polygon);
/// Centre of area.
[[nodiscard]] cv::Point2d centroid(const Polygon& polygon);
/// The polygon scaled about the origin, then moved.
[[nodiscard]] Polygon placed(const Polygon& polygon, double scale, cv::Point2d offset);

}  // namespace todbench
