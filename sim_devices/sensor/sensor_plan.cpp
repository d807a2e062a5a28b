// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/sensor_plan.h"

#include <algorithm>

#include "sim_devices/sensor/effect_row.h"

namespace todbench {
namespace {

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

}  // namespace

bool SensorPlan::simulates(Effect effect) const {
  return std::any_of(decisions.begin(), decisions.end(), [effect](const EffectDecision& decision) {
    return decision.effect == effect && decision.decision == Decision::simulate;
  });
}

bool is_neutral(const SensorSpec& spec, Effect effect, SceneMotion motion) {
  const EffectRow& row = row_of(effect);
  return row.is_neutral != nullptr && row.is_neutral(spec, motion);
}

SensorSpec as_planned(SensorSpec spec, const SensorPlan& plan) {
  for (const Effect effect : all_effects) {
    const EffectRow& row = row_of(effect);
    if (row.neutralise != nullptr && !plan.simulates(effect)) row.neutralise(spec);
  }
  return spec;
}

SensorPlan full_plan(const SensorSpec& spec, const std::vector<Effect>& skip, const std::vector<Effect>& force,
                     SceneMotion motion) {
  SensorPlan plan;
  for (const Effect effect : all_effects) {
    EffectDecision decision{.effect = effect,
                            .decision = Decision::simulate,
                            .reason = "part of the full chain",
                            .predicted_change_percent = std::nullopt};
    if (is_neutral(spec, effect, motion)) {
      decision = {effect, Decision::skip, "neutral in this sensor: " + std::string(row_of(effect).neutral), 0.0};
    }
    if (contains(skip, effect)) {
      decision.decision = Decision::skip;
      decision.reason = "skipped on request";
      decision.on_request = true;
    }
    if (contains(force, effect)) {
      decision.decision = Decision::simulate;
      decision.reason = "simulated on request";
      decision.on_request = false;
      decision.predicted_change_percent = std::nullopt;
    }
    plan.decisions.push_back(std::move(decision));
  }
  return plan;
}

}  // namespace todbench
