// SPDX-License-Identifier: GPL-3.0-or-later
// Plan with the seed of --seed.
#pragma once

#include "bench/cli/commands.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// Returns the plan with the seed of the command line, if given. Errors: those of `plan` and of LoadedPlan::with().
[[nodiscard]] Result<LoadedPlan> with_seed(Result<LoadedPlan> plan, const CommonOptions& common);

}  // namespace todbench
