// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/simulation_plan.h"

#include <algorithm>
#include <utility>

#include "bench/forecast/default_design.h"

namespace todbench {
namespace {

/// Appends the effects of the command line to those of the plan.
void add_effects(std::vector<Effect>& list, const std::vector<Effect>& before) {
  std::vector<Effect> all = before;
  for (const Effect effect : list) {
    if (std::find(all.begin(), all.end(), effect) == all.end()) all.push_back(effect);
  }
  list = std::move(all);
}

}  // namespace

Result<LoadedPlan> simulation_plan(const SimulationOverrides& overrides, std::stop_token stop) {
  auto loaded = read_plan(overrides.plan.empty() ? "demo" : overrides.plan);
  if (!loaded) return loaded;
  const Plan before = overrides.plan.empty() ? plan_of_nobody(loaded->plan()) : loaded->plan();
  Plan plan = before;
  if (overrides.seed) plan.seed = *overrides.seed;
  if (auto applied = apply(overrides.keys, plan); !applied) return tl::unexpected(applied.error());
  // A tolerance alone selects the automatic accuracy.
  if (overrides.keys.has("simulation.tolerance_percent") && !overrides.keys.has("simulation.accuracy"))
    plan.simulation.accuracy = "auto";
  add_effects(plan.simulation.skip, before.simulation.skip);
  add_effects(plan.simulation.force, before.simulation.force);
  loaded = loaded->with(plan);
  if (loaded && overrides.keys.has("simulation.sensor") && !overrides.keys.has("simulation.microscan")) {
    plan.simulation.microscan = loaded->parts().sensor.microscan;
    loaded = loaded->with(plan);
  }
  if (!loaded) return tl::unexpected(in_terms_of_options(loaded.error()));
  return overrides.plan.empty() ? with_suitable_distance(*loaded, std::move(stop)) : loaded;
}

}  // namespace todbench
