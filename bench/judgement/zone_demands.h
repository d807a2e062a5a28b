// SPDX-License-Identifier: GPL-3.0-or-later
// Demands on the pixels of a zone: rows of the table of demand kinds.
#pragma once

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Returns the row. Precondition: `kind` belongs to [[limits.zone]].
[[nodiscard]] DemandKindRow zone_row(DemandKind kind);

}  // namespace todbench
