// SPDX-License-Identifier: GPL-3.0-or-later
// Computing time against accuracy for a plan: the frontier of its simulated sensor over choices of the planner and
// numbers of trials.
#pragma once

#include <stop_token>

#include "bench/plan/loaded_plan.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// Measures cost_frontier() for a plan. The planner has these choices: the request of the plan (the chosen point), the
/// effects and accuracy for tolerances from 0.5 to 5 %, and the named levels with the effects of the plan. The trials
/// repeat the measurement of the plan on its simulated sensor, including registration, contrast and psychometric fit,
/// with 1, 2, 4, ... of its phases (for an adaptive schedule, of its presentations). Errors: those of
/// LoadedPlan::load(), check_simulated_geometry() and cost_frontier(); `invalid_input` if the tolerance of the plan
/// cannot be met.
[[nodiscard]] Result<CostFrontier> cost_of_plan(const LoadedPlan& loaded, double budget_s, const CostListener& listener,
                                                std::stop_token stop);

}  // namespace todbench
