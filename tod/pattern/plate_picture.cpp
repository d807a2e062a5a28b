// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/pattern/plate_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hvs/shape/polygon_coverage.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

struct CutOut {
  std::string name;
  Polygon outline_px;
};

std::vector<CutOut> cut_outs(const TargetPlate& plate, cv::Point2d shift_mm, const DisplayGeometry& display) {
  std::vector<CutOut> found;
  for (const PlateTriangle& t : plate.triangles)
    found.push_back({t.name, triangle(t.size_mm, t.apex, t.position_mm + shift_mm)});
  for (const PlateRectangle& r : plate.rectangles) {
    found.push_back({r.name, outline_mm(r)});
    for (auto& corner : found.back().outline_px) corner += shift_mm;
  }
  const cv::Point2d middle(display.size_px.width / 2.0, display.size_px.height / 2.0);
  for (CutOut& one : found) {
    for (auto& corner : one.outline_px) corner = corner / display.pixel_mm + middle;
  }
  return found;
}

}  // namespace

Result<cv::Mat1d> plate_picture(const TargetPlate& mounted_plate, cv::Point2d shift_mm, const DisplayGeometry& display,
                                double ground, double pattern) {
  constexpr int most = 16384;
  const cv::Size size = display.size_px;
  if (size.width < 1 || size.height < 1 || size.width > most || size.height > most ||
      !(std::isfinite(display.pixel_mm) && display.pixel_mm > 0))
    return fail(ErrorCode::invalid_input,
                fmt::format("the display must have from 1 to {} pixels on each side and a positive pixel size", most));
  for (const double level : {ground, pattern}) {
    if (!(level >= 0 && level <= 1))
      return fail(ErrorCode::invalid_input, "the levels of a display must be from 0 to 1");
  }
  cv::Mat1d cover(size, 0.0);
  for (const CutOut& one : cut_outs(mounted_plate, shift_mm, display)) {
    double left = size.width, right = 0, top = size.height, bottom = 0;
    for (const auto& corner : one.outline_px) {
      left = std::min(left, corner.x);
      right = std::max(right, corner.x);
      top = std::min(top, corner.y);
      bottom = std::max(bottom, corner.y);
    }
    if (!(left >= 0 && top >= 0 && right <= size.width && bottom <= size.height)) {
      return fail(ErrorCode::invalid_input, fmt::format("plate {}: '{}' leaves the display of {} x {} pixels",
                                                        mounted_plate.name, one.name, size.width, size.height));
    }
    const cv::Point origin(static_cast<int>(left), static_cast<int>(top));
    const cv::Size part_size(std::min(size.width - origin.x, static_cast<int>(std::ceil(right)) - origin.x),
                             std::min(size.height - origin.y, static_cast<int>(std::ceil(bottom)) - origin.y));
    if (part_size.width < 1 || part_size.height < 1) continue;
    cv::Mat1d part = cover(cv::Rect(origin, part_size));
    part += pixel_coverage(placed(one.outline_px, 1, -cv::Point2d(origin)), part_size);
  }
  for (double& value : cover) value = ground + (pattern - ground) * std::clamp(value, 0.0, 1.0);
  return cover;
}

}  // namespace todbench
