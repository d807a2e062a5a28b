// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/registration/patch_windows.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

namespace todbench {
namespace {

constexpr double blur_allowance_px = 1.5;

/// Distance from a point to a segment.
double distance(cv::Point2d p, cv::Point2d a, cv::Point2d b) {
  const cv::Point2d d = b - a;
  const double t = std::clamp((p - a).dot(d) / d.dot(d), 0.0, 1.0);
  return std::hypot(p.x - a.x - t * d.x, p.y - a.y - t * d.y);
}

bool inside(cv::Point2d p, const Polygon& convex) {
  int turns = 0;
  for (std::size_t i = 0; i < convex.size(); ++i)
    turns += (convex[(i + 1) % convex.size()] - convex[i]).cross(p - convex[i]) > 0 ? 1 : -1;
  return std::abs(turns) == static_cast<int>(convex.size());
}

/// Distance between two convex polygons; 0 if they overlap.
double distance(const Polygon& a, const Polygon& b) {
  double smallest = 1e300;
  for (const auto& [p, q] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const auto& vertex : *p) {
      if (inside(vertex, *q)) return 0;
      for (std::size_t i = 0; i < q->size(); ++i)
        smallest = std::min(smallest, distance(vertex, (*q)[i], (*q)[(i + 1) % q->size()]));
    }
  }
  return smallest;
}

}  // namespace

PatchWindow patch_window(cv::Point2d centroid_px, int side) {
  CV_Assert(side > 0 && side % 2 == 0);
  const int left = static_cast<int>(std::floor(centroid_px.x));  // the corner right of and below pixel (left, top)
  const int top = static_cast<int>(std::floor(centroid_px.y));
  return {.pixels = cv::Rect(left + 1 - side / 2, top + 1 - side / 2, side, side),
          .phase = {centroid_px.x - left - 0.5, centroid_px.y - top - 0.5}};
}

std::string sentence(const TouchingWindow& window) {
  return fmt::format("{}: its window of {} px comes within {:.1f} px of {}, at least {:.1f} px are needed",
                     window.triangle, window.side_px, window.gap_px, window.neighbour, window.least_gap_px);
}

std::string sentence(const WindowOutOfPicture& window) {
  const cv::Rect& at = window.window;
  return fmt::format("{}: its window, columns {} to {} and rows {} to {}, is not inside the picture of {} x {} pixels",
                     window.triangle, at.x, at.x + at.width - 1, at.y, at.y + at.height - 1, window.picture.width,
                     window.picture.height);
}

std::vector<TouchingWindow> touching_windows(const TargetPlate& plate, const RegistrationOptions& options,
                                             const std::vector<int>& sides, double search_px) {
  const double scale = options.expected_scale_px_per_mm;
  const auto in_pixels = [&](cv::Point2d at_mm) {
    return cv::Point2d(at_mm.x * scale, at_mm.y * scale / options.pixel_aspect);
  };
  std::vector<TouchingWindow> problems;
  for (std::size_t i = 0; i < plate.triangles.size(); ++i) {
    const cv::Point2d centre = in_pixels(plate.triangles[i].position_mm);
    const double half = sides[i] / 2.0 + search_px + 0.5;
    const Polygon window{centre + cv::Point2d(-half, -half), centre + cv::Point2d(half, -half),
                         centre + cv::Point2d(half, half), centre + cv::Point2d(-half, half)};
    for (std::size_t j = 0; j < plate.triangles.size(); ++j) {
      if (j == i) continue;
      const auto& other = plate.triangles[j];
      Polygon shape = triangle(other.size_mm, other.apex, other.position_mm);
      for (auto& corner : shape) corner = in_pixels(corner);
      const double gap = distance(window, shape);
      if (gap >= blur_allowance_px) continue;
      problems.push_back({.triangle = plate.triangles[i].name,
                          .neighbour = other.name,
                          .side_px = sides[i],
                          .gap_px = gap,
                          .least_gap_px = blur_allowance_px});
      break;
    }
  }
  return problems;
}

std::vector<WindowOutOfPicture> windows_out_of_picture(const TargetPlate& mounted_plate,
                                                       const Registration& registration, const std::vector<int>& sides,
                                                       cv::Size picture) {
  std::vector<WindowOutOfPicture> problems;
  const cv::Rect inner(1, 1, picture.width - 2, picture.height - 2);
  for (std::size_t i = 0; i < mounted_plate.triangles.size(); ++i) {
    const auto window = patch_window(registration.pixel(mounted_plate.triangles[i].position_mm), sides[i]).pixels;
    if ((window & inner) == window) continue;
    problems.push_back({mounted_plate.triangles[i].name, window, picture});
  }
  return problems;
}

}  // namespace todbench
