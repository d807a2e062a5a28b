// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/seeded_plan.h"

#include <utility>

namespace todbench {

Result<LoadedPlan> with_seed(Result<LoadedPlan> plan, const CommonOptions& common) {
  if (!plan || !common.seed_given) return plan;
  Plan seeded = plan->plan();
  seeded.seed = common.seed;
  return plan->with(std::move(seeded));
}

}  // namespace todbench
