// SPDX-License-Identifier: GPL-3.0-or-later
// Plan after the choice of a camera.
#pragma once

#include <string>

#include "bench/plan/plan.h"

namespace todbench {

/// Returns the plan for a connected camera, without values that belong to another camera, so that none of them reaches
/// the report of a real unit. Removed are:
/// - values of the plans `demo`, `acceptance` and of the emulated laboratory (texts, operator, addresses, times of
/// changes, limits, rows of the budget) and the IFOV of their camera;
/// - IFOV, unit and settings of another camera.
/// A simulated or emulated target becomes an operator, kind 'prompt'. Values that the user entered stay; a list of
/// limits or rows that the user changed stays complete.
[[nodiscard]] Plan plan_for_camera(Plan plan, const std::string& id);
/// Returns the plan for the emulated laboratory, with the values of the demonstration in place of those that
/// plan_for_camera() removed.
[[nodiscard]] Plan plan_for_laboratory(Plan plan);
/// Returns the plan for a simulated sensor in front of its scene. Errors: those of load_sensor().
[[nodiscard]] Result<Plan> plan_for_sensor(Plan plan, const std::string& name);

}  // namespace todbench
