// SPDX-License-Identifier: GPL-3.0-or-later
// Demands on the pixels of a zone: rows of the table of demand kinds.
#pragma once

#include <vector>

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Returns a row for each number that [[limits.zone]] can limit.
[[nodiscard]] std::vector<DemandKindRow> zone_rows();

}  // namespace todbench
