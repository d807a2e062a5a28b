// A measurement design for a sensor that nobody wrote a plan for.
#pragma once

#include <stop_token>

#include "bench/plan/loaded_plan.h"

namespace todbench {

/// The plan without a unit under test, its limits, camera and instruments: a simulation that nobody wrote a plan for.
[[nodiscard]] Plan plan_of_nobody(Plan plan);

/// The plan with the distance at which the sizes of its plates straddle the 75 % sizes that a draft estimate predicts
/// for its contrasts, as far as the plates fit into the picture. Leaves the distance alone where there is no estimate.
/// Errors: `interrupted`.
[[nodiscard]] Result<LoadedPlan> with_suitable_distance(const LoadedPlan& loaded, std::stop_token stop);

}  // namespace todbench
