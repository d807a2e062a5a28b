// SPDX-License-Identifier: GPL-3.0-or-later
// Time against accuracy for a plan: the frontier of its simulated sensor, with choices of the planner and trials.
#pragma once

#include <stop_token>

#include "bench/plan/loaded_plan.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// Measures cost_frontier() for a plan. Planner's choices: the request of the plan (chosen), the effects and accuracy
/// for tolerances from 0.5 to 5 %, and the named levels with the effects of the plan. Trials: the plan's own
/// measurement on its simulated sensor with 1, 2, 4, ... of its phases (adaptive: presentations), including
/// registration, contrast and psychometric fit. Errors: those of LoadedPlan::load(), check_simulated_geometry() and
/// cost_frontier(); `invalid_input` if the tolerance of the plan cannot be met.
[[nodiscard]] Result<CostFrontier> cost_of_plan(const LoadedPlan& loaded, double budget_s, const CostListener& listener,
                                                std::stop_token stop);

}  // namespace todbench
