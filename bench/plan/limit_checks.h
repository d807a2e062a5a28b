// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of limits, zones, fleet and budget against the rest of the plan. Each
// returns the mistakes of the value; its comment states the condition for a correct one.
#pragma once

#include <cstddef>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Requires the pixel check and a name that no earlier row has.
[[nodiscard]] ValueMistakes check_zone_name(const Plan& plan, std::size_t row);
/// Not empty, and without overlap with earlier rows, except the zone of the whole frame.
[[nodiscard]] ValueMistakes check_zone_area(const Plan& plan, std::size_t row);
/// At least one limit.
[[nodiscard]] ValueMistakes check_zone_limits(const Plan& plan, std::size_t row);
/// One of the contrasts of the target, not in an earlier row.
[[nodiscard]] ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row);
/// Above the uncertainty of a ratio from the budget rows that do not cancel between camera and twin.
[[nodiscard]] ValueMistakes check_margin(const Plan& plan, std::size_t row);
/// A measure that [measures] requests, not in an earlier row.
[[nodiscard]] ValueMistakes check_limited_measure(const Plan& plan, std::size_t row);
/// A measure that can have a limit, not in an earlier row; an acuity needs its contrast.
[[nodiscard]] ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row);
/// One or two limits, with room between them for a value and its stated uncertainty.
[[nodiscard]] ValueMistakes check_measure_limits(const Plan& plan, std::size_t row);
/// A budget with `require` states every expected row.
[[nodiscard]] ValueMistakes check_require(const Plan& plan, std::size_t row);
/// Not in an earlier row, and not the name of a row that a run adds.
[[nodiscard]] ValueMistakes check_budget_name(const Plan& plan, std::size_t row);
/// A unit that fits the input of the row, unless a sensitivity converts it.
[[nodiscard]] ValueMistakes check_budget_unit(const Plan& plan, std::size_t row);
/// Only for a normal distribution.
[[nodiscard]] ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row);

}  // namespace todbench
