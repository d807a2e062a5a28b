// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that a plan names, loaded and checked against each other.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "bench/plan/loaded_plan.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// Inputs of a run: the parts of a plan, and the planner's decisions about them.
struct ExperimentInputs {
  std::vector<TargetPlate> plates;            ///< plates of the trials
  std::optional<TargetPlate> mtf_plate{};     ///< if an MTF is requested
  std::optional<TargetPlate> ctf_plate{};     ///< if a CTF is requested
  std::optional<TargetPlate> source_plate{};  ///< if the size-of-source effect is requested
  std::optional<TargetPlate> open_plate{};    ///< if absolute temperatures are requested
  std::optional<TargetPlate> mrtd_plate{};    ///< if an MRTD is requested
  TemplateObserverSpec observer;
  SensorSpec sensor;                      ///< as planned: parameters of skipped effects have their neutral values
  double stated_noise_counts = 0;         ///< temporal noise of the sensor with all effects, in counts
  SensorPlan effects;                     ///< effects that the scene needs within the tolerance, with reasons
  std::vector<ContrastOutlook> outlooks;  ///< prediction for each contrast with a threshold
  SceneMotion motion{};
  std::vector<std::string> warnings;  ///< warnings of the planner, one sentence each
  bool identifiable = true;           ///< at least one contrast has a threshold
  Accuracy accuracy;
};

/// Returns the planner's decisions for the scenes of a plan. Errors: those of plan_effects().
[[nodiscard]] Result<EffectPlan> planned_effects(const Plan& plan, const SensorSpec& sensor,
                                                 const TemplateObserverSpec& observer, EffectPlanner& planner);

/// Compares the stated IFOV of the camera with pitch over focal length of the simulated sensor. Returns a sentence if
/// they differ by 1 % or more; empty otherwise, and without a camera. Errors: `invalid_input` about the key if the
/// value is wrong by a factor of about a thousand.
[[nodiscard]] Result<std::string> check_ifov(const Plan& plan, const SensorSpec& sensor);

/// Loads the inputs and runs the planner once. If no contrast has a threshold, every effect is simulated, with a
/// warning. With modules, every effect is simulated without the planner.
[[nodiscard]] Result<ExperimentInputs> experiment_inputs(const LoadedPlan& loaded, EffectPlanner& planner);

/// Returns the transmittance of the stated air in the band of the sensor. Empty if the plan states no air, and for a
/// simulated scene, which has no air. Errors: those of bench_transmittance().
[[nodiscard]] Result<std::optional<double>> stated_air(const Plan& plan, const SensorSpec& sensor);

/// Sets the kind of answers by chosen_answers(); without this call the answers are binary.
void take_answers(MeasurementOptions& options, const Plan& plan, const ExperimentInputs& inputs);

/// Returns the options for the simulated sensor: the camera's options without settling and corrections.
[[nodiscard]] MeasurementOptions simulated_options(const Plan& plan, const ExperimentInputs& inputs);

/// Checks that all sizes fit into the picture and keep their distance from neighbours. Errors: `invalid_input` with up
/// to three sizes that do not fit. Call it before the first calculation or movement.
[[nodiscard]] Result<void> check_measured_geometry(const Plan& plan, const ExperimentInputs& inputs, cv::Size picture);
/// Makes the same checks for the picture of the simulated sensor, and checks that this picture fits into the memory of
/// this machine.
[[nodiscard]] Result<void> check_simulated_geometry(const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
