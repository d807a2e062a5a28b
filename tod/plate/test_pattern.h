// SPDX-License-Identifier: GPL-3.0-or-later
// The TOD test pattern: an equilateral triangle in four orientations (Bijl and Valeton 1998).
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "hvs/observer/observer.h"
#include "hvs/shape/polygon.h"

namespace todbench {

/// Direction of the apex, with x right and y down. All lists of alternatives have this order, which is clockwise.
enum class Apex { up, right, down, left };
inline constexpr std::array all_apexes{Apex::up, Apex::right, Apex::down, Apex::left};

[[nodiscard]] std::string_view to_string(Apex apex);
[[nodiscard]] std::optional<Apex> apex_from(std::string_view name);

/// Constants of a triangle of size 1. The size is the square root of the area.
inline constexpr double triangle_side = 1.5196713713031853;              ///< 2 / 3^(1/4)
inline constexpr double triangle_height = 1.3160740129524924;            ///< 3^(1/4)
inline constexpr double triangle_centroid_to_apex = 0.8773826753016616;  ///< 2/3 of the height
inline constexpr double triangle_centroid_to_base = 0.4386913376508308;  ///< 1/3 of the height

/// Returns a triangle of `size`, rotated about its centroid, which is at `centroid`.
[[nodiscard]] Polygon triangle(double size, Apex apex, cv::Point2d centroid = {0, 0});

/// Returns the four orientations at size 1, in the order of Apex.
[[nodiscard]] Alternatives triangle_alternatives();

}  // namespace todbench
