// SPDX-License-Identifier: GPL-3.0-or-later
// Demands on physical measures: rows of the table of demand kinds.
#pragma once

#include <vector>

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Returns a row for each limit that a quantity can have, in the order of the table of quantities.
[[nodiscard]] std::vector<DemandKindRow> measure_rows();

}  // namespace todbench
