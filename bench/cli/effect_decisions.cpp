// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/cli/effect_decisions.h"

#include <utility>

#include "bench/session/fit_record.h"

namespace todbench {

void EffectDecisionOptions::add_to(CLI::App& command) {
  command.add_flag("--why", why, why_text);
  command.add_flag("--dry-run", dry_run, "states the simulated and skipped effects with their reasons, and ends");
}

std::string no_criterion_for(const std::string& scene) {
  return "every effect that is not neutral is simulated: the criteria of the planner bound the acuity for triangles, "
         "not " +
         scene;
}

void print_effect_table(const Console& console, const SensorPlan& plan, bool why) {
  std::vector<TableRow> effects, last;
  std::string neutral;
  for (const auto& d : plan.decisions) {
    TableRow row{std::string(to_string(d.effect)), d.decision == Decision::simulate ? "simulate" : "skip",
                 fixed(d.predicted_change_percent, 3), d.reason};
    (d.changes_nothing() ? last : effects).push_back(std::move(row));
    if (d.changes_nothing()) neutral += (neutral.empty() ? "" : ", ") + std::string(to_string(d.effect));
  }
  if (why) effects.insert(effects.end(), last.begin(), last.end());
  console.table({"effect", "decision", "change if skipped [%]", "reason"}, effects);
  if (!why && !neutral.empty())
    console.text("neutral in this sensor, so skipped without a change (--why states each reason): " + neutral);
}

void print_effects(const Console& console, const DecidedEffects& effects, const EffectDecisionOptions& options) {
  console.text("");
  if (!effects.plan.decisions.empty()) {
    console.text("effects of " + effects.sensor + ":");
    print_effect_table(console, effects.plan, options.why);
  }
  console.text(effects.promise);
}

void add_effects(Json& json, const DecidedEffects& effects) {
  json["effects"] = effects_json(effects.plan);
  json["promise"] = effects.promise;
}

int dry_run(Console& console, const std::vector<DecidedEffects>& effects, const EffectDecisionOptions& options) {
  if (console.json()) {
    Json models = Json::array();
    for (const DecidedEffects& one : effects) {
      Json model{{"sensor", one.sensor}};
      add_effects(model, one);
      models.push_back(std::move(model));
    }
    if (effects.size() != 1) {
      console.object({{"models", std::move(models)}});
    } else {
      models.front().erase("sensor");
      console.object(models.front());
    }
    return 0;
  }
  for (const DecidedEffects& one : effects) print_effects(console, one, options);
  return 0;
}

}  // namespace todbench
