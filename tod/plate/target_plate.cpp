// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/plate/target_plate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>
#include <utility>

#include "acquisition/base/try.h"

namespace todbench {
namespace {

/// Largest gap between two convex polygons over the directions perpendicular to their edges (separating axis theorem):
/// > 0 exactly if they are apart.
double separation(const Polygon& a, const Polygon& b) {
  double best = -std::numeric_limits<double>::infinity();
  for (const Polygon* owner : {&a, &b}) {
    for (std::size_t i = 0; i < owner->size(); ++i) {
      const cv::Point2d edge = (*owner)[(i + 1) % owner->size()] - (*owner)[i];
      const cv::Point2d axis = cv::Point2d(edge.y, -edge.x) / std::hypot(edge.x, edge.y);
      const auto along = [&](const cv::Point2d& p, const cv::Point2d& q) { return p.dot(axis) < q.dot(axis); };
      const auto [a_low, a_high] = std::ranges::minmax_element(a, along);
      const auto [b_low, b_high] = std::ranges::minmax_element(b, along);
      best = std::max({best, b_low->dot(axis) - a_high->dot(axis), a_low->dot(axis) - b_high->dot(axis)});
    }
  }
  return best;
}

bool inside(const Polygon& polygon, double half_width, double half_height) {
  return std::ranges::all_of(
      polygon, [&](const cv::Point2d& p) { return std::abs(p.x) <= half_width && std::abs(p.y) <= half_height; });
}

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

Error refusal(const TargetPlate& plate, const std::string& what) {
  return {ErrorCode::invalid_input, "plate \"" + plate.name + "\": " + what};
}

std::string number(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

/// Checks of the cut-outs, one after the other.
class CutOuts {
 public:
  explicit CutOuts(const TargetPlate& plate) : plate_(plate) {}

  Result<void> add(const std::string& name, cv::Point2d position_mm, const Polygon& outline) {
    if (!names_.insert(name).second)
      return tl::unexpected(refusal(plate_, "two cut-outs have the name \"" + name + "\""));
    if (!inside(outline, plate_.width_mm / 2, plate_.height_mm / 2)) {
      return tl::unexpected(refusal(plate_, name + " at (" + number(position_mm.x) + ", " + number(position_mm.y) +
                                                ") mm leaves the plate of " + number(plate_.width_mm) + " x " +
                                                number(plate_.height_mm) + " mm"));
    }
    for (const auto& [other, there] : outlines_) {
      if (!(separation(there, outline) > 0)) return tl::unexpected(refusal(plate_, name + " touches " + other));
    }
    outlines_.emplace_back(name, outline);
    return {};
  }

 private:
  const TargetPlate& plate_;
  std::set<std::string> names_;
  std::vector<std::pair<std::string, Polygon>> outlines_;
};

/// Whether a mounting flips x and y: {x, y}. Every mounting is its own inverse, and two of them combine to the mounting
/// that flips an axis if exactly one of them does (the Klein four-group).
struct Flips {
  bool x, y;
};

Flips flips(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return {false, false};
    case Mounting::rotated_180:
      return {true, true};
    case Mounting::mirrored_horizontally:
      return {true, false};
    case Mounting::mirrored_vertically:
      return {false, true};
  }
  return {false, false};
}

}  // namespace

std::string_view to_string(Mounting mounting) {
  switch (mounting) {
    case Mounting::identity:
      return "identity";
    case Mounting::rotated_180:
      return "rotated_180";
    case Mounting::mirrored_horizontally:
      return "mirrored_horizontally";
    case Mounting::mirrored_vertically:
      return "mirrored_vertically";
  }
  return "unknown";
}

std::optional<Mounting> mounting_from(std::string_view name) {
  for (const Mounting mounting : all_mountings) {
    if (to_string(mounting) == name) return mounting;
  }
  return std::nullopt;
}

Result<void> validate(const TargetPlate& plate) {
  if (!positive(plate.width_mm) || !positive(plate.height_mm)) {
    return tl::unexpected(refusal(plate, "width_mm and height_mm must be positive, found " + number(plate.width_mm) +
                                             " and " + number(plate.height_mm)));
  }
  if (plate.triangles.empty() && plate.rectangles.empty() && plate.bars.empty())
    return tl::unexpected(refusal(plate, "it has no triangles and no rectangles"));
  for (const PlateBars& b : plate.bars) {
    if (!positive(b.bar_mm) || !positive(b.length_mm) || !std::isfinite(b.angle_deg))
      return tl::unexpected(refusal(plate, b.name + ": bar_mm and length_mm must be positive"));
  }
  CutOuts cut_outs(plate);
  for (const PlateTriangle& t : plate.triangles) {
    if (!positive(t.size_mm)) {
      return tl::unexpected(refusal(plate, t.name + ": size_mm must be positive, found " + number(t.size_mm)));
    }
    auto added = cut_outs.add(t.name, t.position_mm, triangle(t.size_mm, t.apex, t.position_mm));
    if (!added) return added;
  }
  for (const PlateRectangle& r : straight_cut_outs(plate)) {
    if (!positive(r.size_mm.width) || !positive(r.size_mm.height) || !std::isfinite(r.angle_deg))
      return tl::unexpected(refusal(plate, r.name + ": width_mm and height_mm must be positive"));
    TODBENCH_TRY_VOID(cut_outs.add(r.name, r.position_mm, outline_mm(r)));
  }
  return {};
}

Polygon outline_mm(const PlateRectangle& rectangle) {
  const double angle = rectangle.angle_deg * std::numbers::pi / 180;
  const cv::Point2d along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
  const cv::Point2d a = along * (rectangle.size_mm.width / 2), b = across * (rectangle.size_mm.height / 2);
  const cv::Point2d at = rectangle.position_mm;
  return {at - a - b, at + a - b, at + a + b, at - a + b};
}

std::vector<PlateRectangle> straight_cut_outs(const TargetPlate& plate) {
  std::vector<PlateRectangle> all = plate.rectangles;
  for (const PlateBars& group : plate.bars) {
    const double angle = group.angle_deg * std::numbers::pi / 180;
    const cv::Point2d across(std::cos(angle), std::sin(angle));
    for (int i = 0; i < 4; ++i) {
      all.push_back({group.name + ", bar " + std::to_string(i + 1),
                     group.position_mm + across * ((2 * i - 3) * group.bar_mm),
                     {group.bar_mm, group.length_mm},
                     group.angle_deg});
    }
  }
  return all;
}

Apex mounted(Apex apex, Mounting mounting) {
  const Flips f = flips(mounting);
  switch (apex) {
    case Apex::up:
      return f.y ? Apex::down : Apex::up;
    case Apex::down:
      return f.y ? Apex::up : Apex::down;
    case Apex::right:
      return f.x ? Apex::left : Apex::right;
    case Apex::left:
      return f.x ? Apex::right : Apex::left;
  }
  return apex;
}

Mounting combined(Mounting first, Mounting second) {
  const Flips a = flips(first);
  const Flips b = flips(second);
  const bool x = a.x != b.x;
  const bool y = a.y != b.y;
  if (x && y) return Mounting::rotated_180;
  if (x) return Mounting::mirrored_horizontally;
  return y ? Mounting::mirrored_vertically : Mounting::identity;
}

TargetPlate mounted(const TargetPlate& plate, Mounting mounting) {
  const Flips f = flips(mounting);
  TargetPlate result = plate;
  for (PlateTriangle& t : result.triangles) {
    // 0 - x instead of -x: a triangle in the middle stays at +0 and compares and prints as before.
    if (f.x) t.position_mm.x = 0 - t.position_mm.x;
    if (f.y) t.position_mm.y = 0 - t.position_mm.y;
    t.apex = mounted(t.apex, mounting);
  }
  for (PlateRectangle& r : result.rectangles) {
    if (f.x) r.position_mm.x = 0 - r.position_mm.x;
    if (f.y) r.position_mm.y = 0 - r.position_mm.y;
    if (f.x != f.y) r.angle_deg = 0 - r.angle_deg;
  }
  for (PlateBars& b : result.bars) {
    if (f.x) b.position_mm.x = 0 - b.position_mm.x;
    if (f.y) b.position_mm.y = 0 - b.position_mm.y;
    if (f.x != f.y) b.angle_deg = 0 - b.angle_deg;
  }
  result.mounting = combined(plate.mounting, mounting);
  return result;
}

}  // namespace todbench
