// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/studies/cost_study.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/devices/devices.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "bench/twin/experiment_inputs.h"
#include "bench/twin/simulated_set_up.h"
#include "bench/twin/twin_shapes.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

/// Standard error for a 95 % interval of a threshold, assumed normal in the logarithm.
std::optional<double> standard_error(const PsychometricFit& fit) {
  if (!fit.threshold || !fit.ci95.low || !fit.ci95.high || !(*fit.ci95.low > 0)) return std::nullopt;
  return *fit.threshold * std::log(*fit.ci95.high / *fit.ci95.low) / (2 * normal_z95);
}

/// Measures the plan on its simulated sensor from the start, like `simulate`.
Result<std::vector<ThresholdEstimate>> from_trials(const Plan& plan, const ExperimentInputs& inputs,
                                                   std::stop_token stop) {
  TODBENCH_TRY(auto set_up, simulated_set_up(plan, inputs, {}, stop));
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  TODBENCH_TRY(const auto result, measure(*set_up.bench.camera, *set_up.bench.target, observer, *set_up.schedule,
                                          set_up.options, *set_up.bench.host, MeasurementListener{}, stop));
  if (result.ended_by) return tl::unexpected(*result.ended_by);
  TODBENCH_TRY(auto curve, tod_curve(result.trials, fit_options(plan)));
  if (chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape) {
    auto outcome = fit_twin_shapes(curve, result.trials, inputs, fit_options(plan),
                                   direct_options(curve, inputs, {}, plan.seed, stop));
    if (outcome.ended_by) return tl::unexpected(*std::move(outcome.ended_by));
  }
  fit_right_and_wrong(curve, result.trials, fit_options(plan));
  std::vector<ThresholdEstimate> found;
  const double ifov_mrad = inputs.sensor.ifov_mrad();
  for (const TodPoint& point : curve.points) {
    if (!point.fit.threshold) continue;
    const auto error = standard_error(point.fit);
    found.push_back({.delta_t_k = point.set_delta_t_k,
                     .s75_pitch = *point.fit.threshold / ifov_mrad,
                     .standard_error_pitch = error ? std::optional(*error / ifov_mrad) : std::nullopt});
  }
  return found;
}

/// 1, 2, 4, ... and the number itself.
std::vector<int> doublings(int first, int last) {
  std::vector<int> out;
  for (int n = first; n < last; n *= 2) out.push_back(n);
  out.push_back(last);
  return out;
}

std::vector<CostTrials> trials_of(const Plan& plan, const ExperimentInputs& inputs) {
  std::vector<CostTrials> runs;
  const auto add = [&](const Plan& varied, const std::string& setting, double cost) {
    runs.push_back({.setting = setting, .relative_cost = cost, .measure = [varied, &inputs](std::stop_token stop) {
                      return from_trials(varied, inputs, std::move(stop));
                    }});
  };
  Plan varied = plan;
  if (plan.schedule.kind == ScheduleKind::adaptive) {
    for (const int n : doublings(std::max(1, plan.schedule.max_presentations / 8), plan.schedule.max_presentations)) {
      varied.schedule.max_presentations = n;
      add(varied, "up to " + std::to_string(n) + " presentations", n);
    }
    return runs;
  }
  for (const int phases : doublings(1, plan.simulation.phases)) {
    varied.simulation.phases = phases;
    double trials = 0;
    for (std::size_t i = 0; i < inputs.plates.size(); ++i)
      trials += static_cast<double>(inputs.plates[i].triangles.size() * mountings_of(plan.target, i));
    trials *= static_cast<double>(plan.target.delta_t_k.size());
    trials *= phases;
    add(varied, number_text(trials), phases);
  }
  return runs;
}

std::vector<CostChoice> choices_of(const Plan& plan, const SensorSpec& sensor, const ExperimentInputs& inputs,
                                   EffectPlanner& planner) {
  std::vector<CostChoice> choices;
  choices.push_back({.setting = "as planned: " + plan.simulation.accuracy + ", " +
                                number_text(plan.simulation.tolerance_percent) + " %",
                     .effects = inputs.effects,
                     .accuracy = inputs.accuracy,
                     .chosen = true});
  for (const auto& [name, accuracy] : {std::pair("draft", Accuracy::draft()), std::pair("normal", Accuracy::normal()),
                                       std::pair("reference", Accuracy::reference())})
    choices.push_back({.setting = name, .effects = inputs.effects, .accuracy = accuracy});
  for (const double tolerance : {5.0, 2.0, 1.0, 0.5}) {
    Plan varied = plan;
    varied.simulation.tolerance_percent = tolerance;
    const auto effects = planned_effects(varied, sensor, inputs.observer, planner);
    choices.push_back({.setting = number_text(tolerance) + " %",
                       .effects = effects ? effects->plan : inputs.effects,
                       .accuracy = Accuracy::for_tolerance(tolerance)});
  }
  return choices;
}

}  // namespace

Result<CostFrontier> cost_of_plan(const LoadedPlan& loaded, double budget_s, const CostListener& listener,
                                  std::stop_token stop) {
  const Plan& plan = loaded.plan();
  EffectPlanner planner;
  TODBENCH_TRY(const auto inputs, experiment_inputs(loaded, planner));
  // Reports in a sentence if the plan cannot be met, before anything is measured.
  TODBENCH_TRY_VOID(predict_plan(plan, inputs));
  if (inputs.outlooks.empty()) {
    CostFrontier nothing;
    nothing.budget_s = budget_s;
    nothing.notes = inputs.warnings;
    return nothing;
  }
  TODBENCH_TRY_VOID(check_simulated_geometry(plan, inputs));
  const SensorSpec& sensor = loaded.sensor();
  auto choices = choices_of(plan, sensor, inputs, planner);
  const CostTask task{.sensor = sensor,
                      .full = full_plan(sensor, {}, {}, plan.simulation.motion),
                      .observer = inputs.observer,
                      .motion = inputs.motion,
                      .delta_t_k = plan.target.delta_t_k,
                      .choices = std::move(choices),
                      .trials = trials_of(plan, inputs),
                      .seed = plan.seed,
                      .budget_s = budget_s};
  return cost_frontier(task, listener, std::move(stop));
}

}  // namespace todbench
