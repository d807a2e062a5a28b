// Everything that a plan names, and whether it fits together.
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

/// What a run works with: the parts of a plan, and what the planner decided about them.
struct ExperimentInputs {
  std::vector<TargetPlate> plates;         ///< of the trials
  std::optional<TargetPlate> mtf_plate{};  ///< where an MTF is asked for
  std::optional<TargetPlate> ctf_plate{};  ///< where a CTF is asked for
  TemplateObserverSpec observer;
  SensorSpec sensor;                      ///< as planned: parameters of skipped effects at their neutral values
  SensorPlan effects;                     ///< what the scene calls for within the tolerance, and why
  std::vector<ContrastOutlook> outlooks;  ///< per contrast that has a threshold
  SceneMotion motion{};
  std::vector<std::string> warnings;  ///< of the planner, a sentence each
  bool identifiable = true;           ///< a contrast has a threshold
  Accuracy accuracy;
};

/// The planner's decisions for what a plan shows. Errors as plan_effects().
[[nodiscard]] Result<EffectPlan> planned_effects(const Plan& plan, const SensorSpec& sensor,
                                                 const TemplateObserverSpec& observer, EffectPlanner& planner);

/// Asks the planner once; where no contrast has a threshold everything is simulated, and a warning says so;
/// with modules it is not asked and everything is simulated.
[[nodiscard]] Result<ExperimentInputs> experiment_inputs(const LoadedPlan& loaded, EffectPlanner& planner);

/// What the air that the plan states leaves of a contrast in the band of the sensor; nothing where it states none, and
/// before a simulated scene, which has none. Errors: bench_transmittance().
[[nodiscard]] Result<std::optional<double>> stated_air(const Plan& plan, const SensorSpec& sensor);

/// The answers that chosen_answers() says; without it they are right or wrong.
void take_answers(MeasurementOptions& options, const Plan& plan, const ExperimentInputs& inputs);

/// How the simulated sensor is measured: as the camera, but nothing has to settle and nothing is corrected.
[[nodiscard]] MeasurementOptions simulated_options(const Plan& plan, const ExperimentInputs& inputs);

/// `invalid_input` naming up to three sizes that do not fit into the picture or too near their neighbours. To be asked
/// before anything is computed or moved.
[[nodiscard]] Result<void> check_measured_geometry(const Plan& plan, const ExperimentInputs& inputs, cv::Size picture);
[[nodiscard]] Result<void> check_simulated_geometry(const Plan& plan, const ExperimentInputs& inputs);

}  // namespace todbench
