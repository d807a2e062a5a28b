// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/experiment_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "acquisition/base/machine_memory.h"
#include "acquisition/base/try.h"
#include "bench/plan/bench_air.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "tod/measurement/geometry.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

constexpr double thousand = 1000;

/// Asks whether the distance is in other units, if every size fits at a distance of another power of a thousand.
std::string distance_hint(MeasurementOptions options, TemplateObserver& observer, cv::Size picture) {
  const double stated_m = options.distance_m;
  for (const auto& [factor, unit] : {std::pair(1 / thousand, "mm"), std::pair(thousand, "km")}) {
    options.distance_m = stated_m * factor;
    const auto misfits = find_misfits(options, observer, picture);
    if (misfits && misfits->empty()) return std::string("; is distance_m in ") + unit + "?";
  }
  return "";
}

/// Names a few sizes that do not fit, before anything is computed or moved.
Result<void> check_geometry(const MeasurementOptions& options, const ExperimentInputs& inputs, cv::Size picture) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  TODBENCH_TRY(auto misfits, find_misfits(options, observer, picture));
  if (misfits.empty()) return {};
  constexpr std::size_t named = 3;
  const std::string distance = number_text(options.distance_m) + " m";
  const std::string what = sentences(misfits, named) + distance_hint(options, observer, picture);
  return tl::unexpected(Error{ErrorCode::invalid_input,
                              "not measurable at " + distance + " ([target] distance_m): " + what,
                              ErrorKey{"target.distance_m", "not measurable at " + distance + ": " + what}});
}

}  // namespace

Result<std::string> check_ifov(const Plan& plan, const SensorSpec& sensor) {
  const double stated = plan.camera.ifov_mrad;
  if (!(stated > 0) || plan.camera.id.empty()) return std::string();
  // A camera that scans may send its samples as pixels.
  const double ratio = stated / sensor.ifov_mrad();
  const double of_samples = ratio * sensor.samples_per_pitch();
  const double nearest = std::abs(std::log(of_samples)) < std::abs(std::log(ratio)) ? of_samples : ratio;
  const std::string twin = fmt::format("{:.4g}", sensor.ifov_mrad()) + " mrad (pitch " + number_text(sensor.pitch_um) +
                           " um / focal length " + number_text(sensor.focal_length_mm) + " mm of " + sensor.name + ")";
  const std::string words = number_text(stated) + " mrad, but that of the simulated sensor is " + twin;
  for (const auto& [factor, unit] : {std::pair(thousand, "rad"), std::pair(1 / thousand, "urad")}) {
    constexpr double closeness = 1.5;
    if (std::abs(std::log(nearest * factor)) > std::log(closeness)) continue;
    return fail_at(ErrorCode::invalid_input, "camera.ifov_mrad",
                   "[camera] ifov_mrad is " + words + "; is the value in " + unit + "?");
  }
  constexpr double noted_from = 0.01;
  if (std::abs(nearest - 1) < noted_from) return std::string();
  return "the plan states an IFOV of " + words + ": acuities of camera and simulated sensor refer to these angles";
}

Result<EffectPlan> planned_effects(const Plan& plan, const SensorSpec& sensor, const TemplateObserverSpec& observer,
                                   EffectPlanner& planner) {
  return planner.plan(sensor, observer, {.delta_t_k = plan.target.delta_t_k, .motion = plan.simulation.motion},
                      {.tolerance_percent = plan.simulation.tolerance_percent,
                       .skip = plan.simulation.skip,
                       .force = plan.simulation.force});
}

Result<ExperimentInputs> experiment_inputs(const LoadedPlan& loaded, EffectPlanner& planner) {
  const Plan& plan = loaded.plan();
  ExperimentInputs inputs;
  inputs.plates = loaded.plates();
  inputs.mtf_plate = loaded.parts().mtf_plate;
  inputs.ctf_plate = loaded.parts().ctf_plate;
  inputs.source_plate = loaded.parts().source_plate;
  inputs.open_plate = loaded.parts().open_plate;
  inputs.mrtd_plate = loaded.parts().mrtd_plate;
  inputs.observer = loaded.observer();
  inputs.motion = plan.simulation.motion;
  inputs.stated_noise_counts = noise_in_counts(loaded.sensor());
  TODBENCH_TRY(auto ifov, check_ifov(plan, loaded.sensor()));
  if (has_modules(plan, loaded.sensor())) {
    if (chosen_estimator(plan, loaded.sensor()).estimator == FitEstimator::twin_shape)
      return fail(
          ErrorCode::invalid_input,
          "the psychometric functions of the sensor do not include a module: [fit] estimator must be 'weibull' or "
          "'automatic'");
    if (plan.schedule.answers == AnswersChoice::graded)
      return fail(
          ErrorCode::invalid_input,
          "graded answers are fitted with the psychometric function of the sensor, which does not include a module: "
          "[schedule] answers must be 'binary' or 'automatic'");
    TODBENCH_TRY_VOID(check_sensor_module(loaded.sensor(), inputs.motion));
    if (const ModulePlan* module = sensor_module(loaded.sensor())) {
      if (plan.measures.any())
        return fail(ErrorCode::invalid_input,
                    "physical measures are compared with the closed forms of the sensor, and a module in place of the "
                    "sensor has none: remove [measures]");
      inputs.warnings.push_back("the simulated sensor is the module '" + one_line(module->command) +
                                "'; it receives the keys of the sensor file");
    }
    // An effect that is negligible for the sensor alone may matter behind a module.
    inputs.effects = full_plan(loaded.sensor(), plan.simulation.skip, plan.simulation.force, inputs.motion);
  } else if (auto effects = planned_effects(plan, loaded.sensor(), inputs.observer, planner)) {
    inputs.effects = std::move(effects->plan);
    inputs.outlooks = std::move(effects->outlooks);
    inputs.warnings = std::move(effects->warnings);
  } else {
    inputs.identifiable = false;
    // Without a threshold there is no reference for a small change, so no effect is skipped.
    inputs.effects = full_plan(loaded.sensor(), plan.simulation.skip, plan.simulation.force, inputs.motion);
    inputs.warnings.push_back(effects.error().message);
  }
  inputs.sensor = as_planned(loaded.sensor(), inputs.effects);
  TODBENCH_TRY(inputs.accuracy, accuracy_of(plan));
  // Behind the warnings of the planner, of which the first is the reason of a run without a threshold.
  if (!ifov.empty()) inputs.warnings.push_back(std::move(ifov));
  return inputs;
}

Result<std::optional<double>> stated_air(const Plan& plan, const SensorSpec& sensor) {
  if (plan.target.kind == TargetKind::scene) return std::optional<double>();
  const CollimatorPlan& collimator = plan.target.collimator;
  const bool through = collimator.stated() && collimator.transmission != 1;
  if (!(plan.target.air_humidity_percent > 0))
    return through ? std::optional(collimator.transmission) : std::optional<double>();
  const auto found = bench_transmittance(
      {.temperature_c = plan.target.air_temperature_c, .humidity_percent = plan.target.air_humidity_percent},
      plan.target.distance_m, {sensor.wavelength_min_um, sensor.wavelength_max_um});
  if (!found) return fail("[target] air_humidity_percent", found.error());
  return std::optional(through ? collimator.transmission * *found : *found);
}

void take_answers(MeasurementOptions& options, const Plan& plan, const ExperimentInputs& inputs) {
  const AnswersTaken answers = chosen_answers(plan, inputs.sensor);
  options.answers = answers.kind;
  options.frames_per_presentation = answers.frames;
  for (const double delta_t_k : plan.target.delta_t_k)
    options.frames_at_contrast[delta_t_k] = chosen_answers(plan, inputs.sensor, delta_t_k).frames;
}

MeasurementOptions simulated_options(const Plan& plan, const ExperimentInputs& inputs) {
  MeasurementOptions options =
      measurement_options(plan, inputs.plates, inputs.sensor.ifov_mrad() / inputs.sensor.samples_per_pitch());
  options.samples_per_pitch = inputs.sensor.samples_per_pitch();
  // The blur of optics and detector grows with the number of samples; a smaller triangle does not show where it points.
  constexpr double least_pitches = 1.25;
  options.registration.min_triangle_px =
      std::max(options.registration.min_triangle_px, least_pitches * options.samples_per_pitch);
  take_answers(options, plan, inputs);
  options.frames_after_change = 0;
  options.nuc_interval_s = 0;
  options.free_running = false;
  options.max_shift_error_px = 0;        // the simulated scene shows the plate at the requested place
  options.max_readback_deviation_k = 0;  // the scene shows the contrast that the camera observed, not the set one
  // A simulated sensor repeats no frames and has no corrections. Strong noise of rows looks like one, and the wait
  // after it is in time of the host: a fast simulation would then never end.
  options.integrity.reject_frozen = false;
  return options;
}

Result<void> check_measured_geometry(const Plan& plan, const ExperimentInputs& inputs, cv::Size picture) {
  TODBENCH_TRY_VOID(stated_air(plan, inputs.sensor));
  return check_geometry(measurement_options(plan, inputs.plates, plan.camera.ifov_mrad), inputs, picture);
}

Result<void> check_simulated_geometry(const Plan& plan, const ExperimentInputs& inputs) {
  TODBENCH_TRY_VOID(check_picture_memory(inputs.sensor, machine_memory_bytes()));
  const int samples = inputs.sensor.samples_per_pitch();
  return check_geometry(simulated_options(plan, inputs), inputs,
                        {inputs.sensor.width * samples, inputs.sensor.height * samples});
}

}  // namespace todbench
