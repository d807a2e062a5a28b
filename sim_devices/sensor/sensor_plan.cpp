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
    EffectRow{Effect::spectral_band, "spectral_band", ""},
    EffectRow{Effect::aberration, "aberration", "aberration_sigma_pitch is 0"},
    EffectRow{Effect::detector, "detector", ""},
    EffectRow{Effect::motion, "motion", "time_constant_ms is 0 or nothing moves"},
    EffectRow{Effect::microscan, "microscan", "microscan is 1"},
    EffectRow{Effect::temporal_noise, "temporal_noise", "netd_k is 0"},
    EffectRow{Effect::fixed_pattern, "fixed_pattern", "fixed_pattern_k is 0"},
    EffectRow{Effect::row_column_noise, "row_column_noise", "row_noise_k and column_noise_k are 0"},
    EffectRow{Effect::dead_pixels, "dead_pixels", "dead_pixel_share is 0"},
    EffectRow{Effect::frame_averaging, "frame_averaging", "frames_averaged is 1"},
    EffectRow{Effect::super_resolution, "super_resolution", "super_resolution_frames is 0"},
    EffectRow{Effect::display, "display", "sample and hold without blur"},
    EffectRow{Effect::quantisation, "quantisation", ""},
};

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

bool is_neutral(const SensorSpec& spec, Effect effect, SceneMotion motion) {
  switch (effect) {
    case Effect::aberration:
      return spec.aberration_sigma_pitch == 0;
    case Effect::motion:
      return spec.time_constant_ms == 0 || !motion.moving();
    case Effect::microscan:
      return spec.microscan == 1;
    case Effect::temporal_noise:
      return spec.netd_k == 0;
    case Effect::fixed_pattern:
      return spec.fixed_pattern_k == 0;
    case Effect::row_column_noise:
      return spec.row_noise_k == 0 && spec.column_noise_k == 0;
    case Effect::dead_pixels:
      return spec.dead_pixel_share == 0;
    case Effect::frame_averaging:
      return spec.frames_averaged == 1;
    case Effect::super_resolution:
      return spec.super_resolution_frames == 0;
    case Effect::display:
      return spec.display == DisplayReconstruction::sample_and_hold && spec.display_blur_samples == 0;
    case Effect::diffraction:
    case Effect::spectral_band:
    case Effect::detector:
    case Effect::quantisation:
      return false;
  }
  return false;
}

SensorSpec as_planned(SensorSpec spec, const SensorPlan& plan) {
  if (!plan.simulates(Effect::aberration)) spec.aberration_sigma_pitch = 0;
  if (!plan.simulates(Effect::motion)) spec.time_constant_ms = 0;
  if (!plan.simulates(Effect::microscan)) spec.microscan = 1;
  if (!plan.simulates(Effect::temporal_noise)) spec.netd_k = 0;
  if (!plan.simulates(Effect::fixed_pattern)) spec.fixed_pattern_k = 0;
  if (!plan.simulates(Effect::row_column_noise)) spec.row_noise_k = spec.column_noise_k = 0;
  if (!plan.simulates(Effect::dead_pixels)) spec.dead_pixel_share = 0;
  if (!plan.simulates(Effect::frame_averaging)) spec.frames_averaged = 1;
  if (!plan.simulates(Effect::super_resolution)) spec.super_resolution_frames = 0;
  if (!plan.simulates(Effect::display)) {
    spec.display = DisplayReconstruction::sample_and_hold;
    spec.display_blur_samples = 0;
  }
  return spec;
}

SensorPlan full_plan(const SensorSpec& spec, const std::vector<Effect>& skip, const std::vector<Effect>& force,
                     SceneMotion motion) {
  SensorPlan plan;
  for (const auto& row : table) {
    EffectDecision decision{.effect = row.effect,
                            .decision = Decision::simulate,
                            .reason = "part of the full chain",
                            .predicted_change_percent = std::nullopt};
    if (is_neutral(spec, row.effect, motion)) {
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
