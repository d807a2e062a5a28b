// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the place of a moving plate in a frame.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// Source of the place of the plate in a frame of a pass.
enum class PlaceSource {
  triangles,  ///< place of the large triangles of that frame
  stage,      ///< a straight line in device time at the stage's speed, through the mean place of the large triangles
};
inline constexpr std::array all_place_sources{PlaceSource::triangles, PlaceSource::stage};
[[nodiscard]] constexpr std::string_view to_string(PlaceSource source) {
  return source == PlaceSource::triangles ? "triangles" : "stage";
}

}  // namespace todbench
