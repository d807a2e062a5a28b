// SPDX-License-Identifier: GPL-3.0-or-later
// Source of the position of a moving plate in a frame.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// Source of the position of the plate in a frame of a pass.
enum class PlaceSource {
  triangles,  ///< position of the large triangles in this frame
  /// Position that moves with device time on a straight line, at the speed of the translation stage. The line goes
  /// through the mean position of the large triangles.
  stage,
};
inline constexpr std::array all_place_sources{PlaceSource::triangles, PlaceSource::stage};
[[nodiscard]] constexpr std::string_view to_string(PlaceSource source) {
  return source == PlaceSource::triangles ? "triangles" : "stage";
}

}  // namespace todbench
