// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/polygon.h"

#include <cmath>

namespace todbench {
namespace {

/// Twice the signed area: positive when the vertices turn from +x towards +y.
double doubled_area(const Polygon& polygon) {
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    sum += a.x * b.y - b.x * a.y;
  }
  return sum;
}

}  // namespace

double area(const Polygon& polygon) {
  return std::abs(doubled_area(polygon)) / 2;
}

cv::Point2d centroid(const Polygon& polygon) {
  cv::Point2d sum(0, 0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    sum += (a + b) * (a.x * b.y - b.x * a.y);
  }
  return sum / (3 * doubled_area(polygon));
}

Polygon placed(const Polygon& polygon, double scale, cv::Point2d offset) {
  Polygon moved;
  moved.reserve(polygon.size());
  for (const auto& vertex : polygon) moved.push_back(vertex * scale + offset);
  return moved;
}

}  // namespace todbench
