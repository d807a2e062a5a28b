// SPDX-License-Identifier: GPL-3.0-or-later
// Table of demand kinds: one row for each DemandKind with its unit, its rule of judgement and its text.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/verdict.h"
#include "bench/plan/quantity.h"

namespace todbench {

/// Row of the table of demand kinds.
struct DemandKindRow {
  DemandKind kind;
  std::string_view unit;  ///< unit of limit, result and interval
  LimitSide side;
  /// Returns all demands of this kind; empty if there are none.
  std::vector<Demand> (*judge)(const DemandKindRow& row, const JudgementInput& evidence);
  std::string (*in_words)(const DemandKindRow& row, const Demand& demand);
  const Quantity* quantity = nullptr;  ///< quantity of a limit on a physical measure; null for other limits
};

/// Returns all kinds in the order of judgement and presentation.
[[nodiscard]] std::span<const DemandKindRow> demand_kinds();
/// Returns the row of a kind.
[[nodiscard]] const DemandKindRow& row_of(DemandKind kind);

/// Returns the measured quantity with this name (measures.json); null if not measured. The pointer is valid as long as
/// `evidence`.
[[nodiscard]] const MeasuredQuantity* quantity_of(const JudgementInput& evidence, std::string_view measure);

/// Returns the demand in words, "acuity at 16.9 K at least 0.4 1/mrad".
[[nodiscard]] std::string in_words(const Demand& demand);
/// Returns the demand in words for the start of a line: "Acuity at 16.9 K at least 0.4 1/mrad".
[[nodiscard]] std::string title(const Demand& demand);

}  // namespace todbench
