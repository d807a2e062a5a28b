// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/default_design.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/twin/experiment_inputs.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/measurement/geometry.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

/// The largest distance from `nearest_m` to that of the plan at which the windows of the observer keep clear of the
/// neighbouring triangles: their sides are whole pitches and a margin, so they shrink less than the plate. That of the
/// plan if there is none, whose check then names the sizes.
double distance_of_clear_windows(Plan plan, const LoadedPlan& loaded, TemplateObserver& observer, double nearest_m) {
  ExperimentInputs inputs;
  inputs.plates = loaded.plates();
  inputs.observer = loaded.observer();
  inputs.sensor = loaded.sensor();
  const int samples = inputs.sensor.samples_per_pitch();
  const cv::Size picture(inputs.sensor.width * samples, inputs.sensor.height * samples);
  const double chosen_m = plan.target.distance_m;
  constexpr double step = 0.98;
  for (; plan.target.distance_m >= nearest_m; plan.target.distance_m *= step) {
    const auto misfits = find_misfits(simulated_options(plan, inputs), observer, picture);
    if (!misfits) return chosen_m;
    if (misfits->empty()) return plan.target.distance_m;
  }
  return chosen_m;
}

}  // namespace

Plan plan_of_nobody(Plan plan) {
  plan.name = "simulate";
  plan.description = plan.operator_name = plan.place = plan.unit = "";
  plan.limits = {};
  plan.camera = {};
  plan.target.kind = TargetKind::scene;
  plan.target.black_body = plan.target.stage = "";
  return plan;
}

Result<LoadedPlan> with_suitable_distance(const LoadedPlan& loaded, std::stop_token stop) {
  Plan plan = loaded.plan();
  const SensorSpec& sensor = loaded.sensor();
  TemplateObserver observer(loaded.observer(), triangle_alternatives());
  const SensorPlan effects = full_plan(sensor, plan.simulation.skip, plan.simulation.force, plan.simulation.motion);
  double log_sum = 0;
  int found = 0;
  for (const double contrast : plan.target.delta_t_k) {
    const auto point = direct_estimate(sensor, effects, observer, {contrast},
                                       {.motion = plan.simulation.motion, .accuracy = Accuracy::draft(), .stop = stop});
    if (!point && point.error().code == ErrorCode::interrupted) return tl::unexpected(point.error());
    if (!point) continue;
    log_sum += std::log(point->front().s75_pitch * sensor.ifov_mrad());
    ++found;
  }
  if (found == 0) return loaded;
  const double middle_mrad = std::exp(log_sum / found);
  double smallest = 1e300, largest = 0, extent_mm = 0;
  for (const auto& plate : loaded.plates()) {
    for (const auto& t : plate.triangles) {
      smallest = std::min(smallest, t.size_mm);
      largest = std::max(largest, t.size_mm);
    }
    const double across = sensor.pitch_aspect() * sensor.height / sensor.width;  // height of the picture over its width
    extent_mm = std::max({extent_mm, plate.width_mm * across, plate.height_mm});
  }
  const double middle_mm = std::sqrt(smallest * largest);
  // The plate may fill 90 % of the picture.
  const double nearest_m = extent_mm / (0.9 * sensor.height * sensor.ifov_mrad(PitchAxis::y));
  // Registration and contrast need triangles of at least five displayed samples.
  const double farthest_m = largest * sensor.samples_per_pitch() / (5.0 * sensor.ifov_mrad());
  plan.target.distance_m = std::max(nearest_m, std::min(middle_mm / middle_mrad, farthest_m));
  plan.target.distance_m = distance_of_clear_windows(plan, loaded, observer, nearest_m);
  return loaded.with(std::move(plan));
}

}  // namespace todbench
