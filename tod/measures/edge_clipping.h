// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether one of the two levels of an edge is clipped.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "tod/measures/edge_line.h"

namespace todbench {

/// Properties of an edge that are determined before the test.
struct EdgeLevels {
  double dark = 0, bright = 0;
  double width_pitch = 0;  ///< distance from 10 to 90 % of the step
  double steepest = 0;     ///< largest slope of the profile per pitch
  double count_step = 0;   ///< step of a picture of integer counts, otherwise 0
};

/// Returns the clipped side ("bright" or "dark"); empty if no side is clipped. A side is clipped in two cases: the
/// plateau has a single value although the neighbouring values scatter, or the profile has a corner at the plateau.
[[nodiscard]] std::optional<std::string_view> clipped_side(const std::vector<EdgeSample>& samples,
                                                           const EdgeLevels& levels);

}  // namespace todbench
