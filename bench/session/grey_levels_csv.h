// SPDX-License-Identifier: GPL-3.0-or-later
// Contrasts in grey levels by frame, as CSV.
#pragma once

#include <string>
#include <vector>

#include "tod/measurement/grey_levels.h"

namespace todbench {

/// Returns one row per judged frame in the order of the run, below a header with units.
[[nodiscard]] std::string grey_levels_csv(const std::vector<GreyFrame>& frames);

}  // namespace todbench
