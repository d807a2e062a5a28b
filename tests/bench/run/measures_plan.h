// SPDX-License-Identifier: GPL-3.0-or-later
// A short plan with physical measures, and a look at what it found.
#pragma once

#include <optional>
#include <string_view>

#include "bench/plan/descriptions.h"
#include "bench/plan/plan.h"
#include "bench/session/measures_record.h"

namespace todbench::testing {

/// Of the simulated sensor: the demonstration at one contrast, with noise and signal transfer.
inline Plan measures_plan() {
  Plan plan = *load_plan("demo");
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  plan.camera = {};
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9};
  plan.target.phases = 2;
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 2;
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 8;
  plan.limits = {};
  plan.measures.noise = true;
  plan.measures.noise_frames = 16;
  plan.measures.transfer = true;
  return plan;
}

/// With this measure alone.
inline Plan plan_of_one(bool MeasuresPlan::*measure) {
  Plan plan = measures_plan();
  plan.measures.noise = plan.measures.transfer = false;
  plan.measures.*measure = true;
  return plan;
}

/// Nothing where the side has no such line.
inline const MeasureLine* line_of(const std::optional<MeasureLines>& side, std::string_view name) {
  if (!side) return nullptr;
  for (const MeasureLine& line : side->lines) {
    if (line.measure == name) return &line;
  }
  return nullptr;
}

}  // namespace todbench::testing
