// Demands on physical measures: their rows in the table of demands.
#pragma once

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Precondition: a kind of a physical measure.
[[nodiscard]] DemandKindRow measure_row(DemandKind kind);

}  // namespace todbench
