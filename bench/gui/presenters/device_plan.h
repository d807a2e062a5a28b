// SPDX-License-Identifier: GPL-3.0-or-later
// Changes of the plan when the user chooses a different device.
#pragma once

#include <string>

#include "bench/plan/plan.h"

namespace todbench {

/// Returns the plan for a connected camera, without the values of other cameras. The report of a real unit thus
/// contains no value of another camera. Removes:
/// - values of the plans `demo` and `acceptance` and of the emulated laboratory: texts, operator, addresses, times of
///   changes, limits, rows of the budget, and the IFOV of their camera;
/// - IFOV, unit and settings of a different camera.
///
/// Replaces a simulated or emulated target by an operator (kind 'prompt'). Keeps values that the user entered. If the
/// user changed a list of limits or rows, keeps the whole list.
[[nodiscard]] Plan plan_for_camera(Plan plan, const std::string& id);
/// Returns the plan for the emulated laboratory. The values of the demonstration replace the values that
/// plan_for_camera() removed.
[[nodiscard]] Plan plan_for_laboratory(Plan plan);
/// Returns the plan for a simulated sensor in front of its scene. Errors: those of load_sensor().
[[nodiscard]] Result<Plan> plan_for_sensor(Plan plan, const std::string& name);

}  // namespace todbench
