// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/plate/test_pattern.h"

namespace todbench {

std::string_view to_string(Apex apex) {
  switch (apex) {
    case Apex::up:
      return "up";
    case Apex::right:
      return "right";
    case Apex::down:
      return "down";
    case Apex::left:
      return "left";
  }
  return "unknown";
}

std::optional<Apex> apex_from(std::string_view name) {
  for (const Apex apex : all_apexes) {
    if (to_string(apex) == name) return apex;
  }
  return std::nullopt;
}

Polygon triangle(double size, Apex apex, cv::Point2d centroid) {
  const double tip = size * triangle_centroid_to_apex;
  const double base = size * triangle_centroid_to_base;
  const double half = size * triangle_side / 2;
  // Exact quarter turns of the upright triangle: no sine or cosine, so that all four are congruent to the last bit.
  Polygon points{{0, -tip}, {half, base}, {-half, base}};
  for (cv::Point2d& p : points) {
    switch (apex) {
      case Apex::up:
        break;
      case Apex::right:
        p = {-p.y, p.x};
        break;
      case Apex::down:
        p = {-p.x, -p.y};
        break;
      case Apex::left:
        p = {p.y, -p.x};
        break;
    }
    p += centroid;
  }
  return points;
}

Alternatives triangle_alternatives() {
  Alternatives shapes;
  for (const Apex apex : all_apexes) shapes.push_back(triangle(1, apex));
  return shapes;
}

}  // namespace todbench
