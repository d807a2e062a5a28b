// Everything that a plan names, and whether it fits together.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bench/plan/plan.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "sim_devices/sensor/sensor_spec.h"
#include "tod/measurement/measurement.h"

namespace todbench {

/// What a plan names, read once.
struct ExperimentInputs {
  std::vector<TargetPlate> plates;
  TemplateObserverSpec observer;
  SensorSpec sensor;   ///< as planned: parameters of skipped effects at their neutral values
  SensorPlan effects;  ///< what the scene calls for within the tolerance, and why
  SceneMotion motion{};
  std::vector<std::string> warnings;  ///< of the planner, a sentence each
  bool identifiable = true;           ///< a contrast has a threshold
  Accuracy accuracy;
};

/// The planner's decisions for what a plan shows. Errors as plan_effects().
[[nodiscard]] Result<EffectPlan> planned_effects(const Plan& plan, const SensorSpec& sensor,
                                                 const TemplateObserverSpec& observer, EffectPlanner& planner);

/// Errors as the loaders of the parts. Without a planner, one of its own.
[[nodiscard]] Result<ExperimentInputs> read_inputs(const Plan& plan, EffectPlanner& planner);
[[nodiscard]] Result<ExperimentInputs> read_inputs(const Plan& plan);

/// How the simulated sensor is measured: as the camera, but nothing has to settle and nothing is corrected.
[[nodiscard]] MeasurementOptions simulated_options(const Plan& plan, const ExperimentInputs& inputs);

/// `invalid_input` naming up to three sizes that do not fit into the picture or too near their neighbours. To be asked
/// before anything is computed or moved.
[[nodiscard]] Result<void> check_measured_geometry(const Plan& plan, const ExperimentInputs& inputs, cv::Size picture);
[[nodiscard]] Result<void> check_simulated_geometry(const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
