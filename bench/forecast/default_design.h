// SPDX-License-Identifier: GPL-3.0-or-later
// Measurement design for a sensor without a plan.
#pragma once

#include <stop_token>

#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Returns the plan as a pure simulation: without operator, place, unit under test, limits, camera and addresses of
/// instruments.
[[nodiscard]] Plan plan_of_nobody(Plan plan);

/// Returns the plan with a suitable distance: the middle of the sizes of its plates is at the mean 75 % size that a
/// draft estimate predicts for its contrasts. The distance is limited so that the plates fit into the picture, the
/// largest triangle covers at least five displayed samples, and the windows of the observer keep clear of neighbouring
/// triangles. The distance is unchanged if there is no estimate. Errors: `interrupted`.
[[nodiscard]] Result<LoadedPlan> with_suitable_distance(const LoadedPlan& loaded, std::stop_token stop);

}  // namespace todbench
