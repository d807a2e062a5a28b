// SPDX-License-Identifier: GPL-3.0-or-later
// The plan that follows from the choice of a camera.
#pragma once

#include <string>

#include "bench/plan/plan.h"

namespace todbench {

/// Returns the plan for a connected camera. The statements of the plans of the emulated laboratory, `demo` and
/// `acceptance` (words, operator, addresses, times of changes, limits, rows of the budget), their camera's IFOV and the
/// statements about another camera (IFOV, unit, settings) are removed, so that none of them reaches the report of a
/// real unit. A target that was simulated or emulated becomes an operator, kind 'prompt'. Statements of the user stay;
/// a list of limits or rows that the user changed stays whole.
[[nodiscard]] Plan plan_for_camera(Plan plan, const std::string& id);
/// Returns the plan for the emulated laboratory: what plan_for_camera() removed is as in the demonstration.
[[nodiscard]] Plan plan_for_laboratory(Plan plan);
/// Returns the plan for a simulated sensor in front of its scene. Errors: those of load_sensor().
[[nodiscard]] Result<Plan> plan_for_sensor(Plan plan, const std::string& name);

}  // namespace todbench
