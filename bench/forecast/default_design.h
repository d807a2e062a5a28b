// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement design for a sensor without a plan.
#pragma once

#include <stop_token>

#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Returns the plan without unit under test, limits, camera and instruments: a pure simulation.
[[nodiscard]] Plan plan_of_nobody(Plan plan);

/// Returns the plan with a suitable distance: the sizes of its plates bracket the 75 % sizes that a draft estimate
/// predicts for its contrasts, as far as the plates fit into the picture and the windows of the observer keep clear of
/// neighbouring triangles. The distance is unchanged if there is no estimate. Errors: `interrupted`.
[[nodiscard]] Result<LoadedPlan> with_suitable_distance(const LoadedPlan& loaded, std::stop_token stop);

}  // namespace todbench
