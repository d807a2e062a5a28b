// Whether the two levels of an edge were cut off.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "tod/measures/edge_line.h"

namespace todbench {

/// What is known of an edge when it is examined.
struct EdgeLevels {
  double dark = 0, bright = 0;
  double width_pitch = 0;  ///< from 10 to 90 % of the step
  double steepest = 0;     ///< largest slope of the profile per pitch
  double count_step = 0;   ///< of a picture of whole counts 1, else 0
};

/// Which side was cut off ("bright", "dark"), if any: a plateau that sits on one value beside values that scatter, or a
/// profile that meets its plateau with a corner.
[[nodiscard]] std::optional<std::string_view> clipped_side(const std::vector<EdgeSample>& samples,
                                                           const EdgeLevels& levels);

}  // namespace todbench
