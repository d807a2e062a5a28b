#include "sim_devices/sensor/sensor_plan.h"

#include <algorithm>

namespace todbench {
namespace {

/// One line of the table of effects.
struct EffectRow {
  Effect effect;
  std::string_view name;
  std::string_view neutral;  ///< why there is nothing to simulate, where the sensor's parameter is neutral
};

constexpr std::array table{
    EffectRow{Effect::diffraction, "diffraction", ""},
    EffectRow{Effect::aberration, "aberration", "aberration_sigma_pitch is 0"},
    EffectRow{Effect::detector, "detector", ""},
    EffectRow{Effect::temporal_noise, "temporal_noise", "netd_k is 0"},
    EffectRow{Effect::fixed_pattern, "fixed_pattern", "fixed_pattern_k is 0"},
    EffectRow{Effect::quantisation, "quantisation", ""},
};

bool neutral(const SensorSpec& spec, Effect effect) {
  switch (effect) {
    case Effect::aberration:
      return spec.aberration_sigma_pitch == 0;
    case Effect::temporal_noise:
      return spec.netd_k == 0;
    case Effect::fixed_pattern:
      return spec.fixed_pattern_k == 0;
    case Effect::diffraction:
    case Effect::detector:
    case Effect::quantisation:
      return false;
  }
  return false;
}

bool contains(const std::vector<Effect>& effects, Effect effect) {
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

}  // namespace

std::string_view to_string(Effect effect) {
  for (const auto& row : table) {
    if (row.effect == effect) return row.name;
  }
  return "unknown";
}

std::optional<Effect> effect_from(std::string_view name) {
  for (const auto& row : table) {
    if (row.name == name) return row.effect;
  }
  return std::nullopt;
}

bool SensorPlan::simulates(Effect effect) const {
  return std::any_of(decisions.begin(), decisions.end(), [effect](const EffectDecision& decision) {
    return decision.effect == effect && decision.decision == Decision::simulate;
  });
}

SensorPlan full_plan(const SensorSpec& spec, const std::vector<Effect>& skip, const std::vector<Effect>& force) {
  SensorPlan plan;
  for (const auto& row : table) {
    EffectDecision decision{.effect = row.effect,
                            .decision = Decision::simulate,
                            .reason = "part of the full chain",
                            .predicted_change_percent = std::nullopt};
    if (neutral(spec, row.effect)) {
      decision = {row.effect, Decision::skip, "neutral in this sensor: " + std::string(row.neutral), 0.0};
    }
    if (contains(skip, row.effect)) {
      decision.decision = Decision::skip;
      decision.reason = "skipped on request";
    }
    if (contains(force, row.effect)) {
      decision.decision = Decision::simulate;
      decision.reason = "simulated on request";
      decision.predicted_change_percent = std::nullopt;
    }
    plan.decisions.push_back(std::move(decision));
  }
  return plan;
}

}  // namespace todbench
