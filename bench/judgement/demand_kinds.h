// The table of what can be demanded: one row for each DemandKind says its name, how it is judged and how it is shown.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/judgement/verdict.h"

namespace todbench {

/// On which side of its limit a result has to be.
enum class LimitSide {
  at_least,
  at_most,
  none,  ///< the demand is no number
};

struct DemandKindRow {
  DemandKind kind;
  std::string_view name;  ///< in verdict.json
  std::string_view unit;  ///< of limit, result and interval
  LimitSide side;
  std::vector<Demand> (*judge)(const Evidence& evidence);  ///< every demand of this kind; none where none is made
  std::string (*in_words)(const Demand& demand);
};

/// Every kind, in the order in which demands are judged and shown.
[[nodiscard]] std::span<const DemandKindRow> demand_kinds();
[[nodiscard]] const DemandKindRow& row_of(DemandKind kind);
[[nodiscard]] std::string_view to_string(DemandKind kind);

/// What was measured of this name (measures.json); null: nothing was. Lives as long as the evidence.
[[nodiscard]] const MeasuredQuantity* quantity_of(const Evidence& evidence, std::string_view measure);

/// "acuity at 16.9 K at least 0.4 1/mrad"
[[nodiscard]] std::string in_words(const Demand& demand);
/// The same as the first words of a line: "Acuity at 16.9 K at least 0.4 1/mrad".
[[nodiscard]] std::string title(const Demand& demand);

}  // namespace todbench
