// Demands on the pixels of a zone: their rows in the table of demands.
#pragma once

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Precondition: a kind of [[limits.zone]].
[[nodiscard]] DemandKindRow zone_row(DemandKind kind);

}  // namespace todbench
