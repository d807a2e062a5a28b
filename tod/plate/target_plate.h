// SPDX-License-Identifier: GPL-3.0-or-later
// The plate of triangles in front of the camera (T-CAT: Valeton, Bijl, Agterhuis and Kriekaard 2000).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/plate/test_pattern.h"

namespace todbench {

/// One cut-out.
struct PlateTriangle {
  std::string name;  ///< unique on the plate, e.g. "row 2, triangle 3"
  /// Centroid relative to the middle of the plate, x right, y down, as the camera sees it in identity mounting.
  cv::Point2d position_mm;
  double size_mm = 0;  ///< square root of area
  Apex apex = Apex::up;
};

/// A cut-out for measures other than TOD: an edge or a bar.
struct PlateRectangle {
  std::string name;         ///< unique on the plate
  cv::Point2d position_mm;  ///< position of the middle, relative to the middle of the plate as for a triangle
  cv::Size2d size_mm;       ///< before rotation
  double angle_deg = 0;     ///< clockwise rotation
};
/// Returns the corners of a rectangle, clockwise from the corner that is top left before rotation.
[[nodiscard]] Polygon outline_mm(const PlateRectangle& rectangle);

/// Four cut-outs with spaces of the same width: a square wave of 1 / (2 bar_mm) cycles per millimetre.
struct PlateBars {
  std::string name;         ///< unique on the plate
  cv::Point2d position_mm;  ///< position of the middle of the group, as for a triangle
  double bar_mm = 0;        ///< width of a bar and of a space
  double length_mm = 0;     ///< length of a bar
  double angle_deg = 0;     ///< clockwise angle from x to the direction across the bars
};

/// Orientation of the plate in its holder. A mounting changes the positions *and* the directions of the triangles. In
/// the mean over mountings, two effects therefore cancel: an observer's memory of the plate, and an asymmetric camera.
enum class Mounting { identity, rotated_180, mirrored_horizontally, mirrored_vertically };
inline constexpr std::array all_mountings{Mounting::identity, Mounting::rotated_180, Mounting::mirrored_horizontally,
                                          Mounting::mirrored_vertically};
[[nodiscard]] std::string_view to_string(Mounting mounting);
[[nodiscard]] std::optional<Mounting> mounting_from(std::string_view name);

/// A plate according to the drawing. The true direction of a triangle is always that of the drawing and is never
/// determined from the image.
struct TargetPlate {
  std::string name;
  std::string description;
  double width_mm = 0, height_mm = 0;
  std::vector<PlateTriangle> triangles;
  /// Mounting to which the positions and apexes belong. Set by mounted(), never by a file.
  Mounting mounting = Mounting::identity;
  std::vector<PlateRectangle> rectangles{};  ///< not used in trials
  std::vector<PlateBars> bars{};             ///< not used in trials
};

/// Returns the rectangles of a plate, followed by the single bars of the groups ("NAME, bar 1").
[[nodiscard]] std::vector<PlateRectangle> straight_cut_outs(const TargetPlate& plate);

/// Checks a plate. Errors: `invalid_input` (an empty plate, a size that is not positive, a repeated name, or a cut-out
/// that is partly outside the plate or touches another cut-out).
[[nodiscard]] Result<void> validate(const TargetPlate& plate);

/// Returns the mounting that results from both mountings. The order of the mountings has no effect, and the inverse of
/// each mounting is the same mounting (Klein four-group).
[[nodiscard]] Mounting combined(Mounting first, Mounting second);

/// Returns the plate as the camera sees it in a mounting. Positions and apexes are transformed, `mounting` is combined
/// with the present mounting, and names are not changed.
[[nodiscard]] TargetPlate mounted(const TargetPlate& plate, Mounting mounting);
[[nodiscard]] Apex mounted(Apex apex, Mounting mounting);

}  // namespace todbench
