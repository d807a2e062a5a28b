// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of keys of limits, zones, fleet and budget against the rest of the plan. Each function returns the mistakes in
// a value; its comment states the condition for a correct value. `row`: row of a repeated section, otherwise 0.
#pragma once

#include <cstddef>

#include "bench/plan/key_types.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Requires the pixel check and a name that no earlier row has.
[[nodiscard]] ValueMistakes check_zone_name(const Plan& plan, std::size_t row);
/// Requires an area that is not empty and does not overlap with the areas of earlier rows. Ignores the zone of the
/// whole frame.
[[nodiscard]] ValueMistakes check_zone_area(const Plan& plan, std::size_t row);
/// Requires at least one limit.
[[nodiscard]] ValueMistakes check_zone_limits(const Plan& plan, std::size_t row);
/// Requires one of the contrasts of the target that no earlier row has.
[[nodiscard]] ValueMistakes check_limit_contrast(const Plan& plan, std::size_t row);
/// Requires a margin above the uncertainty of a ratio from the budget rows that do not cancel between camera and twin.
[[nodiscard]] ValueMistakes check_margin(const Plan& plan, std::size_t row);
/// Requires a measure that [measures] requests and that no earlier row has.
[[nodiscard]] ValueMistakes check_limited_measure(const Plan& plan, std::size_t row);
/// Requires a measure that can have a limit and that no earlier row has; for an acuity, also its contrast.
[[nodiscard]] ValueMistakes check_fleet_measure(const Plan& plan, std::size_t row);
/// Requires one or two limits, with room between them for a value and its stated uncertainty.
[[nodiscard]] ValueMistakes check_measure_limits(const Plan& plan, std::size_t row);
/// Requires every expected row in a budget with `require`.
[[nodiscard]] ValueMistakes check_require(const Plan& plan, std::size_t row);
/// Requires a name that no earlier row has and that is not the name of a row added by a run.
[[nodiscard]] ValueMistakes check_budget_name(const Plan& plan, std::size_t row);
/// Requires a unit that fits the input of the row, unless a sensitivity converts it.
[[nodiscard]] ValueMistakes check_budget_unit(const Plan& plan, std::size_t row);
/// Requires a normal distribution if a coverage factor is stated.
[[nodiscard]] ValueMistakes check_coverage_factor(const Plan& plan, std::size_t row);

}  // namespace todbench
