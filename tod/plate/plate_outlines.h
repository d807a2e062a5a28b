// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines of a plate's triangles in the picture, and formatting of numbers. Used by the code for registration, shift
// and contrast.
#pragma once

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "hvs/shape/polygon.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Maps a position on the plate (mm) to the picture (px).
[[nodiscard]] inline cv::Point2d to_pixel(const cv::Matx33d& plate_to_pixel, cv::Point2d plate_mm) {
  const cv::Vec3d p = plate_to_pixel * cv::Vec3d(plate_mm.x, plate_mm.y, 1);
  return {p[0] / p[2], p[1] / p[2]};
}

/// Returns the derivative of the mapping at a position, in pixels per millimetre.
[[nodiscard]] inline cv::Matx22d jacobian(const cv::Matx33d& h, cv::Point2d plate_mm) {
  const cv::Vec3d p = h * cv::Vec3d(plate_mm.x, plate_mm.y, 1);
  const double x = p[0] / p[2];
  const double y = p[1] / p[2];
  return cv::Matx22d(h(0, 0) - x * h(2, 0), h(0, 1) - x * h(2, 1), h(1, 0) - y * h(2, 0), h(1, 1) - y * h(2, 1)) *
         (1 / p[2]);
}

/// Returns the outline of a triangle in the picture according to the mapping, with the given apex.
[[nodiscard]] inline Polygon outline_in_picture(const cv::Matx33d& plate_to_pixel, const PlateTriangle& t, Apex apex) {
  Polygon outline = triangle(t.size_mm, apex, t.position_mm);
  for (cv::Point2d& p : outline) p = to_pixel(plate_to_pixel, p);
  return outline;
}

/// Returns the triangles of at least `size_mm`.
[[nodiscard]] inline std::vector<PlateTriangle> triangles_from(const TargetPlate& plate, double size_mm) {
  std::vector<PlateTriangle> large;
  for (const PlateTriangle& t : plate.triangles) {
    if (t.size_mm >= size_mm) large.push_back(t);
  }
  return large;
}

/// Returns `value` with `digits` decimals.
[[nodiscard]] inline std::string fixed(double value, int digits) {
  return fmt::format("{:.{}f}", value, digits);
}

}  // namespace todbench
