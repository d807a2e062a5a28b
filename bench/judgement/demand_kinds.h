// SPDX-License-Identifier: GPL-3.0-or-later
// Table of demand kinds: one row for each DemandKind with its name, its rule of judgement and its words.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/verdict.h"

namespace todbench {

/// Side of the limit on which a result conforms.
enum class LimitSide {
  at_least,
  at_most,
  none,  ///< the demand has no number
};

struct DemandKindRow {
  DemandKind kind;
  std::string_view name;  ///< as in verdict.json
  std::string_view unit;  ///< of limit, result and interval
  LimitSide side;
  std::vector<Demand> (*judge)(const JudgementInput& evidence);  ///< all demands of this kind; empty if there are none
  std::string (*in_words)(const Demand& demand);
};

/// Returns all kinds in the order of judgement and presentation.
[[nodiscard]] std::span<const DemandKindRow> demand_kinds();
[[nodiscard]] const DemandKindRow& row_of(DemandKind kind);
[[nodiscard]] std::string_view to_string(DemandKind kind);

/// Returns the measured quantity with this name (measures.json); null if not measured. Lives as long as the evidence.
[[nodiscard]] const MeasuredQuantity* quantity_of(const JudgementInput& evidence, std::string_view measure);

/// Returns the demand in words, "acuity at 16.9 K at least 0.4 1/mrad".
[[nodiscard]] std::string in_words(const Demand& demand);
/// Returns the same at the start of a line: "Acuity at 16.9 K at least 0.4 1/mrad".
[[nodiscard]] std::string title(const Demand& demand);

}  // namespace todbench
