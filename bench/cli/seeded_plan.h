// The plan of a command that takes it as it is, but for --seed.
#pragma once

#include "bench/cli/commands.h"
#include "bench/plan/loaded_plan.h"

namespace todbench {

/// The plan with the seed of the command line, where that has one. Errors: those of `plan` and of LoadedPlan::with().
[[nodiscard]] Result<LoadedPlan> with_seed(Result<LoadedPlan> plan, const CommonOptions& common);

}  // namespace todbench
