// Demands on physical measures: their rows in the table of demands.
#pragma once

#include <optional>

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Precondition: a kind of a physical measure.
[[nodiscard]] DemandKindRow measure_row(DemandKind kind);
/// Of a demand on a physical measure; nothing of another.
[[nodiscard]] std::optional<LimitedMeasure> limited_measure_of(DemandKind kind);

}  // namespace todbench
