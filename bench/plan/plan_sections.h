// SPDX-License-Identifier: GPL-3.0-or-later
// Sections of the plan keys, each defined in the file of its group.
#pragma once

#include "bench/plan/plan_keys.h"

namespace todbench {

/// Times in seconds, up to four months.
inline constexpr NumberRange up_to_seconds = NumberRange::between(0, 1e7);
/// Numbers without a fixed unit, for measures and budgets.
inline constexpr NumberRange positive = NumberRange::between(1e-12, 1e12);
inline constexpr NumberRange not_negative = NumberRange::between(0, 1e12);
inline constexpr NumberRange any_sign = NumberRange::between(-1e12, 1e12);
inline constexpr NumberRange share = NumberRange::between(0, 1);

/// Return one section each. Defined in bench_keys.cpp:
[[nodiscard]] PlanSection about_section();
[[nodiscard]] PlanSection camera_section();
[[nodiscard]] PlanSection target_section();
[[nodiscard]] PlanSection motion_section();
[[nodiscard]] PlanSection instrument_section();
[[nodiscard]] PlanSection module_section();
[[nodiscard]] PlanSection report_section();

// Defined in condition_keys.cpp:
[[nodiscard]] PlanSection warm_up_section();
[[nodiscard]] PlanSection collimator_section();

// Defined in display_keys.cpp:
[[nodiscard]] PlanSection display_section();

// Defined in order_keys.cpp:
[[nodiscard]] PlanSection order_section();

// Defined in run_keys.cpp:
[[nodiscard]] PlanSection observer_section();
[[nodiscard]] PlanSection simulation_section();
[[nodiscard]] PlanSection schedule_section();
[[nodiscard]] PlanSection fit_section();
[[nodiscard]] PlanSection measurement_section();

// Defined in measure_keys.cpp:
[[nodiscard]] PlanSection measures_section();

// Defined in limit_keys.cpp:
[[nodiscard]] PlanSection limits_section();
[[nodiscard]] PlanSection acuity_limits_section();
[[nodiscard]] PlanSection measure_limits_section();
[[nodiscard]] PlanSection zone_limits_section();
[[nodiscard]] PlanSection fleet_section();
[[nodiscard]] PlanSection uncertainty_section();
[[nodiscard]] PlanSection budget_row_section();

}  // namespace todbench
