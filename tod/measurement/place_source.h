// How the place of a moving plate in a frame is known.
#pragma once

#include <array>
#include <string_view>

namespace todbench {

/// Where the plate is said to be in a frame of a pass.
enum class PlaceSource {
  triangles,  ///< where the large triangles of that frame are
  stage,      ///< on the straight line at the stage's speed over device time, through the middle of those places
};
inline constexpr std::array all_place_sources{PlaceSource::triangles, PlaceSource::stage};
[[nodiscard]] constexpr std::string_view to_string(PlaceSource source) {
  return source == PlaceSource::triangles ? "triangles" : "stage";
}

}  // namespace todbench
