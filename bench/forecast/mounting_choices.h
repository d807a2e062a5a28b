// SPDX-License-Identifier: GPL-3.0-or-later
// Mountings of the plates that designs compare.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/plan/plan.h"

namespace todbench {

/// Returns the mountings in their order, each followed by its counterpart, which is rotated by 180 degrees.
[[nodiscard]] std::vector<Mounting> in_pairs(const std::vector<Mounting>& mountings);

/// Returns the share of the set-ups whose counterpart is not shown with the same plate, 0 to 1.
[[nodiscard]] double unpaired_share(const TargetPlan& target);

/// Returns the choices of the number of mountings of each plate, 1 to `mountings`, with at least `set_ups` in all. More
/// than three plates have the same number each.
[[nodiscard]] std::vector<std::vector<int>> mounting_choices(std::size_t plates, int mountings, std::size_t set_ups);

}  // namespace todbench
