// SPDX-License-Identifier: GPL-3.0-or-later
// Demands on physical measures: rows of the table of demand kinds.
#pragma once

#include <optional>

#include "bench/judgement/demand_kinds.h"

namespace todbench {

/// Returns the row. Precondition: `kind` is a physical measure.
[[nodiscard]] DemandKindRow measure_row(DemandKind kind);
/// Returns the measure of a demand kind; empty if it is not about a physical measure.
[[nodiscard]] std::optional<LimitedMeasure> limited_measure_of(DemandKind kind);

}  // namespace todbench
