#include "bench/cli/simulation_plan.h"

#include <array>
#include <utility>

#include "bench/plan/descriptions.h"
#include "bench/run/default_design.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// A key of a plan, and the option that stands for it.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> option_of_key{
    {{"target.delta_t_k", "--delta-t-k"},
     {"simulation.sensor", "--sensor"},
     {"simulation.accuracy", "--accuracy"},
     {"simulation.tolerance_percent", "--tolerance-percent"},
     {"simulation.skip", "--skip"},
     {"simulation.force", "--force"},
     {"observer.name", "--observer"}}};

/// What is wrong with the plan, said to somebody who wrote options and no plan.
Error in_terms_of_options(const Error& error) {
  if (!error.key) return with_context("with these options", error);
  for (const auto& [key, option] : option_of_key) {
    if (error.key->name == key) return renamed(error, std::string(option));
  }
  return with_context("with these options", renamed(error, error.key->name));
}

Result<std::vector<Effect>> effects_of(const std::vector<std::string>& names, std::string_view option) {
  std::vector<std::string> known;
  for (const Effect effect : all_effects) known.emplace_back(to_string(effect));
  std::vector<Effect> effects;
  for (const auto& name : names) {
    const auto effect = effect_from(name);
    if (!effect) {
      return fail_at(ErrorCode::invalid_input, std::string(option),
                     "unknown effect '" + one_line(name) + "'" + nearest_name_hint(name, known) +
                         " (known: " + quoted_list(known) + ")");
    }
    effects.push_back(*effect);
  }
  return effects;
}

Result<void> apply_effects(const SimulationOverrides& overrides, SimulationPlan& simulation) {
  auto skip = effects_of(overrides.skip, "--skip");
  if (!skip) return tl::unexpected(skip.error());
  auto force = effects_of(overrides.force, "--force");
  if (!force) return tl::unexpected(force.error());
  const auto add = [](std::vector<Effect>& list, const std::vector<Effect>& more) {
    for (const Effect effect : more) {
      if (std::find(list.begin(), list.end(), effect) == list.end()) list.push_back(effect);
    }
  };
  add(simulation.skip, *skip);
  add(simulation.force, *force);
  return {};
}

/// The sensor with its own microscan, unless the command line has one.
Result<void> apply_sensor(const SimulationOverrides& overrides, SimulationPlan& simulation) {
  if (overrides.sensor) {
    simulation.sensor = absolute_reference(*overrides.sensor, "");
    auto sensor = load_sensor(simulation.sensor);
    if (!sensor) return fail("--sensor", sensor.error());
    simulation.microscan = sensor->microscan;
  }
  if (overrides.microscan) simulation.microscan = *overrides.microscan;
  return {};
}

}  // namespace

Result<Plan> simulation_plan(const SimulationOverrides& overrides, std::stop_token stop) {
  auto plan = load_plan(overrides.plan.empty() ? "demo" : overrides.plan);
  if (!plan) return plan;
  if (overrides.plan.empty()) {
    // Without a plan file there is no unit under test, so no limits.
    plan->name = "simulate";
    plan->description = plan->operator_name = plan->place = plan->unit = "";
    plan->limits = {};
    plan->camera = {};
    plan->target.kind = TargetKind::scene;
    plan->target.black_body = plan->target.stage = "";
  }
  if (overrides.seed) plan->seed = *overrides.seed;
  if (overrides.observer) plan->observer = absolute_reference(*overrides.observer, "");
  if (overrides.accuracy) plan->simulation.accuracy = *overrides.accuracy;
  if (overrides.tolerance_percent) {
    plan->simulation.tolerance_percent = *overrides.tolerance_percent;
    // A tolerance is all that needs to be said.
    if (!overrides.accuracy) plan->simulation.accuracy = "auto";
  }
  if (!overrides.delta_t_k.empty()) plan->target.delta_t_k = overrides.delta_t_k;
  if (auto applied = apply_sensor(overrides, plan->simulation); !applied) return tl::unexpected(applied.error());
  if (auto applied = apply_effects(overrides, plan->simulation); !applied) return tl::unexpected(applied.error());
  auto checked = parse_plan({.origin = "command line", .text = to_toml(*plan)}, "");
  if (!checked) return tl::unexpected(in_terms_of_options(checked.error()));
  return overrides.plan.empty() ? with_suitable_distance(*std::move(checked), std::move(stop)) : checked;
}

}  // namespace todbench
