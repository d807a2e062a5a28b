// A measurement design for a sensor that nobody wrote a plan for.
#pragma once

#include <stop_token>

#include "bench/plan/plan.h"

namespace todbench {

/// The plan with the distance at which the sizes of its plates straddle the 75 % sizes that a draft estimate predicts
/// for its contrasts, as far as the plates fit into the picture. Leaves the distance alone where there is no estimate.
/// Errors: as load_sensor, load_plate; `interrupted`.
[[nodiscard]] Result<Plan> with_suitable_distance(Plan plan, std::stop_token stop);

}  // namespace todbench
