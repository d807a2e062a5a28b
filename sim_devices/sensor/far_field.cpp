// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/far_field.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace todbench {
namespace {

constexpr int rays = 8192;

/// The part where normal . x <= limit.
Polygon half_plane(const Polygon& shape, cv::Point2d normal, double limit) {
  Polygon kept;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const cv::Point2d a = shape[i], b = shape[(i + 1) % shape.size()];
    const double beyond_a = normal.dot(a) - limit, beyond_b = normal.dot(b) - limit;
    if (beyond_a <= 0) kept.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0))
      kept.push_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
  return kept;
}

/// Distances at which a ray meets the edges, in ascending order.
std::vector<double> crossings(const Polygon& shape, cv::Point2d from, cv::Point2d direction) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const cv::Point2d a = shape[i] - from, b = shape[(i + 1) % shape.size()] - from;
    // Side of the ray. An end on the ray counts to one side only, so that both edges of a vertex agree.
    const double side_a = direction.cross(a), side_b = direction.cross(b);
    if ((side_a < 0) == (side_b < 0)) continue;
    const double along = direction.dot(a + side_a / (side_a - side_b) * (b - a));
    if (along > 0) distances.push_back(along);
  }
  std::ranges::sort(distances);
  return distances;
}

}  // namespace

Polygon clipped(const Polygon& shape, double half_width) {
  Polygon kept = shape;
  for (const cv::Point2d normal : {cv::Point2d(1, 0), cv::Point2d(-1, 0), cv::Point2d(0, 1), cv::Point2d(0, -1)})
    kept = half_plane(kept, normal, half_width);
  return kept;
}

double far_integral(const Polygon& shape, cv::Point2d from, double half_width) {
  double sum = 0;
  for (int k = 0; k < rays; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / rays;
    const cv::Point2d direction(std::cos(angle), std::sin(angle));
    const auto to_wall = [&](double position, double speed) {
      return speed == 0 ? std::numeric_limits<double>::max() : (std::copysign(half_width, speed) - position) / speed;
    };
    const double wall = std::min(to_wall(from.x, direction.x), to_wall(from.y, direction.y));
    const auto distances = crossings(shape, from, direction);
    // From the farthest crossing inwards: the ray is inside between the last crossing and the one before it, and so on.
    for (std::size_t i = distances.size(); i > 0; i -= std::min<std::size_t>(i, 2)) {
      const double leaves = distances[i - 1], enters = std::max(i > 1 ? distances[i - 2] : 0.0, wall);
      if (leaves > enters) sum += 1 / enters - 1 / leaves;
    }
  }
  return sum * 2 * std::numbers::pi / rays;
}

}  // namespace todbench
