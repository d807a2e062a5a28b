// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/triangle_strip.h"

#include <algorithm>
#include <cmath>

#include "tod/measures/medians.h"

namespace todbench {

TriangleStrip smallest_triangles(const cv::Mat1d& picture, const TargetPlate& mounted_plate, const Registration& where,
                                 int count) {
  constexpr int least_side = 16, margin = 8, gap = 2;
  std::vector<PlateTriangle> triangles = mounted_plate.triangles;
  std::stable_sort(triangles.begin(), triangles.end(),
                   [](const PlateTriangle& a, const PlateTriangle& b) { return a.size_mm < b.size_mm; });
  triangles.resize(std::min(triangles.size(), static_cast<std::size_t>(std::max(1, count))));
  const double scale = where.scale_px_per_mm;
  // The width of an equilateral triangle is 1.52 times the root of its area.
  const double highest = std::max(1.0, 1 / where.pixel_aspect);  // pixels along y for one along x
  const int side =
      std::max(least_side, static_cast<int>(std::ceil(1.52 * triangles.back().size_mm * scale * highest)) + margin);
  const auto windows = static_cast<int>(triangles.size());
  TriangleStrip strip;
  strip.kelvin = cv::Mat1d(side, windows * (side + gap) - gap, median_of(picture));
  const cv::Rect whole(0, 0, picture.cols, picture.rows);
  for (int i = 0; i < windows; ++i) {
    const PlateTriangle& triangle = triangles[static_cast<std::size_t>(i)];
    strip.size_px.push_back(triangle.size_mm * scale);
    const cv::Point2d centre = where.pixel(triangle.position_mm);
    const cv::Point corner(cv::saturate_cast<int>(centre.x) - side / 2, cv::saturate_cast<int>(centre.y) - side / 2);
    const cv::Rect seen = cv::Rect(corner, cv::Size(side, side)) & whole;
    if (seen.empty()) continue;
    picture(seen).copyTo(strip.kelvin(seen - corner + cv::Point(i * (side + gap), 0)));
  }
  double low = 0, high = 0;
  cv::minMaxLoc(strip.kelvin, &low, &high);
  for (int i = 1; i < windows; ++i) strip.kelvin.colRange(i * (side + gap) - gap, i * (side + gap)).setTo(high);
  return strip;
}

}  // namespace todbench
