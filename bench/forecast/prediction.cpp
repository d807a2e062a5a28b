// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "acquisition/base/try.h"
#include "bench/forecast/adaptive_forecast.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/interval_prediction.h"
#include "bench/forecast/ramp_forecast.h"
#include "bench/forecast/time_prediction.h"
#include "bench/forecast/visit_order.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"
#include "sim_devices/prediction/direct_timing.h"

namespace todbench {
namespace {

/// Sets the threshold and the interval that presentations of every set-up in each phase of the simulation have.
void predict_constant(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs) {
  const auto outlook = std::ranges::find(inputs.outlooks, point.delta_t_k, &ContrastOutlook::delta_t_k);
  if (outlook == inputs.outlooks.end()) return;
  point.s75_mrad = outlook->s75_pitch * inputs.sensor.ifov_mrad();
  const auto forecast = answer_forecast(plan, inputs, point.delta_t_k);
  if (!forecast) return;
  predict_interval(point, plan, inputs, *forecast,
                   std::vector<int>(forecast->information.size(), plan.simulation.phases));
}

/// Measurements of each contrast in each set-up.
std::vector<std::vector<int>> looks_of_constant_stimuli(const Plan& plan, const ExperimentInputs& inputs) {
  const std::size_t set_ups = numbered_set_ups(plan, inputs.plates.size()).size();
  return {plan.target.delta_t_k.size(),
          std::vector<int>(set_ups, has_own_contrasts(plan) ? plan.simulation.phases : 1)};
}

/// Rejects a tolerance beyond the caps; the message states the best possible tolerance over all contrasts, and its time
/// on this machine.
Result<void> reachable(const Plan& plan, const ExperimentInputs& inputs) {
  const Accuracy& accuracy = inputs.accuracy;
  const auto draws_at = [&](const ContrastOutlook& outlook) { return needed_draws(accuracy, outlook.q_eff); };
  const auto worst = std::ranges::max_element(inputs.outlooks, {}, draws_at);
  if (worst == inputs.outlooks.end() || draws_at(*worst) <= Accuracy::max_noise_draws) return {};
  // The requested standard error is half the tolerance and falls with the root of the draws.
  const double best = plan.simulation.tolerance_percent * std::sqrt(draws_at(*worst) / Accuracy::max_noise_draws);
  double price_s = 0;
  for (const auto& outlook : inputs.outlooks) {
    const double draws = std::min<double>(draws_at(outlook), Accuracy::max_noise_draws);
    TODBENCH_TRY(const auto price,
                 measured_direct_seconds(inputs.sensor, inputs.effects, inputs.observer, outlook.delta_t_k,
                                         outlook.s75_pitch, draws, accuracy, inputs.motion));
    price_s += price;
  }
  return fail(ErrorCode::invalid_input,
              "a tolerance of " + number_text(plan.simulation.tolerance_percent) + " % cannot be met at " +
                  number_text(worst->delta_t_k) + " K: the maximum of " + std::to_string(Accuracy::max_noise_draws) +
                  " noise draws per size can reach about " + number_text(std::ceil(best * 100) / 100) +
                  " %, in about " + number_text(std::ceil(price_s * 10) / 10) + " s over all contrasts");
}

/// Design at one contrast.
struct ContrastDesign {
  Plan plan;         ///< constant stimuli that are as precise at this contrast as the plan
  double shown = 0;  ///< presentations in each set-up that count for this contrast
};

/// What the presentations of constant stimuli tell at the contrasts that have a threshold.
std::vector<ContrastInformation> informations_of(const Plan& plan, const ExperimentInputs& inputs) {
  std::vector<ContrastInformation> out;
  for (const ContrastOutlook& outlook : inputs.outlooks) {
    if (std::ranges::find(plan.target.delta_t_k, outlook.delta_t_k) == plan.target.delta_t_k.end()) continue;
    const std::vector<double> of_set_ups = set_up_information(plan, inputs, outlook);
    const double sum = std::accumulate(of_set_ups.begin(), of_set_ups.end(), 0.0);
    const double ratio = graded_variance_ratio(graded_design(plan, inputs, outlook, of_set_ups));
    if (sum > 0 && ratio > 0) out.push_back({outlook.delta_t_k, sum, ratio});
  }
  return out;
}

/// The design at each contrast of the plan. That of a ramp comes from its fit over all contrasts.
std::vector<ContrastDesign> contrast_designs(const Plan& plan, const ExperimentInputs& inputs) {
  const std::vector<double>& points_k = plan.target.delta_t_k;
  std::vector<ContrastDesign> out(points_k.size(), {plan, static_cast<double>(plan.simulation.phases)});
  if (plan.schedule.kind != ScheduleKind::ramp || points_k.empty()) return out;
  const std::vector<double> shown_k = ramp_contrasts_k(plan);
  const std::vector<int> nearest = nearest_presentations(points_k, shown_k);
  const auto of_phases = [&](double phases) {
    Plan constant = plan;
    constant.schedule.answers = AnswersChoice::graded;  // a ramp has no others
    constant.simulation.phases = constant.target.phases = std::max(1, static_cast<int>(std::lround(phases)));
    return constant;
  };
  const auto points =
      informations_of(of_phases(static_cast<double>(shown_k.size()) / static_cast<double>(points_k.size())), inputs);
  const ContrastNoise noise{.noise_k = inputs.sensor.netd_k, .internal_noise = inputs.observer.internal_noise};
  const auto equal = points.empty() ? std::vector<double>{} : equal_presentations(points, shown_k, noise);
  for (std::size_t i = 0; i < points_k.size(); ++i) {
    const auto point = std::ranges::find(points, points_k[i], &ContrastInformation::delta_t_k);
    out[i] = {of_phases(point == points.end() ? 1 : equal[static_cast<std::size_t>(point - points.begin())]),
              static_cast<double>(nearest[i])};
  }
  return out;
}

/// Returns a sentence if counts of the sensor do not reach the temperature of the target; empty otherwise.
std::string beyond_range(const SensorSpec& sensor, double delta_t_k) {
  const double highest_k = sensor.offset_k + sensor.kelvin_per_count * (std::exp2(sensor.bits) - 1);
  const double surround_k = sensor.scene_temperature_k, target_k = surround_k + delta_t_k;
  if (std::min(surround_k, target_k) > sensor.offset_k && std::max(surround_k, target_k) < highest_k) return "";
  return fmt::format(
      "at {} K the target of {:.6g} K in a surround of {:.6g} K leaves the range of the simulated sensor, {:.6g} to "
      "{:.6g} K: pixels are saturated, and the result is unfit for a decision",
      number_text(delta_t_k), target_k, surround_k, sensor.offset_k, highest_k);
}

}  // namespace

Plan as_measured(Plan plan) {
  if (!plan.camera.id.empty()) plan.simulation.phases = plan.target.phases;
  return plan;
}

Plan with_frames(Plan plan, const ExperimentInputs& inputs) {
  std::vector<int>& frames = plan.schedule.frames_per_presentation;
  if (!frames.empty() && std::ranges::find(frames, 0) == frames.end()) return plan;
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::binary) {
    frames = {1};
    return plan;
  }
  const double rate_hz = inputs.sensor.frame_rate_hz;
  if (plan.schedule.kind == ScheduleKind::ramp) {
    const int of_step = static_cast<int>(std::floor((ramp_step_s - plan.target.shift_change_s) * rate_hz + 1e-9));
    frames = {std::max(1, of_step - plan.measurement.frames_after_change)};
    return plan;
  }
  Plan single = plan;
  single.schedule.frames_per_presentation = {1};
  const BenchTime time = bench_time(single, inputs.plates, rate_hz, {});
  const double single_s = time.total_s() / std::max(1.0, static_cast<double>(time.presentations));
  std::vector<int> chosen;
  for (const double delta_t_k : plan.target.delta_t_k) {
    chosen.push_back(chosen_answers(plan, inputs.sensor, delta_t_k).frames);
    const auto outlook = std::ranges::find(inputs.outlooks, delta_t_k, &ContrastOutlook::delta_t_k);
    if (frames_at(plan, delta_t_k) == 0 && single_s > 0 && rate_hz > 0 && outlook != inputs.outlooks.end())
      chosen.back() = cheapest_frames(
          graded_design(single, inputs, *outlook, set_up_information(single, inputs, *outlook)), single_s, 1 / rate_hz);
  }
  const bool same = std::ranges::all_of(chosen, [&](int n) { return n == chosen[0]; });
  frames = same && !chosen.empty() ? std::vector<int>{chosen[0]} : chosen;
  return plan;
}

double triangles_of(const std::vector<TargetPlate>& plates) {
  double sum = 0;
  for (const TargetPlate& plate : plates) sum += static_cast<double>(plate.triangles.size());
  return sum;
}

BenchTime expected_bench_time(const Plan& plan, const ExperimentInputs& inputs, const PlanPrediction& prediction) {
  return bench_time(plan, inputs.plates, inputs.sensor.frame_rate_hz, prediction.runs);
}

Result<PlanPrediction> predict_plan(const Plan& asked, const ExperimentInputs& inputs) {
  const Plan plan = with_frames(asked, inputs);
  if (auto none = refuse_modules(plan, inputs.sensor); !none) return tl::unexpected(none.error());
  if (auto met = reachable(plan, inputs); !met) return tl::unexpected(met.error());

  PlanPrediction out{.figures = {}, .contrasts = {}, .runs = {}, .warnings = inputs.warnings};
  for (std::size_t i = 0; const ContrastDesign& design : contrast_designs(plan, inputs)) {
    const double delta_t_k = plan.target.delta_t_k[i++];
    ContrastPrediction point{.delta_t_k = delta_t_k, .s75_mrad = std::nullopt, .uncertainty_percent = std::nullopt};
    for (std::size_t plate = 0; plate < inputs.plates.size(); ++plate)
      point.trials += static_cast<double>(mountings_of(plan.target, plate)) * design.shown *
                      static_cast<double>(inputs.plates[plate].triangles.size());
    std::string saturated = beyond_range(inputs.sensor, delta_t_k);
    if (saturated.empty())
      predict_constant(point, design.plan, inputs);
    else
      out.warnings.push_back(std::move(saturated));
    out.contrasts.push_back(point);
  }
  std::vector<std::vector<int>> looks = looks_of_constant_stimuli(plan, inputs);
  if (plan.schedule.kind == ScheduleKind::adaptive && set_ups_of(plan.target) > 0) {
    AdaptiveForecast adaptive = adaptive_forecast(out.contrasts, plan, inputs);
    out.contrasts = std::move(adaptive.contrasts);
    out.runs = std::move(adaptive.runs);
    looks = std::move(adaptive.looks);
  }
  if (!plan.camera.id.empty() && plan.schedule.kind != ScheduleKind::ramp)
    join_contrast_scatter(out.contrasts, plan, inputs, looks);
  double trials = 0, largest = 0;
  bool all_identified = true;
  for (const ContrastPrediction& point : out.contrasts) {
    trials += point.trials;
    largest = std::max(largest, point.uncertainty_percent.value_or(0));
    if (point.uncertainty_percent) continue;
    all_identified = false;
    if (!beyond_range(inputs.sensor, point.delta_t_k).empty()) continue;
    out.warnings.push_back("at " + number_text(point.delta_t_k) +
                           " K the sizes of the plates do not identify a threshold");
  }
  if (all_identified && !out.contrasts.empty()) out.figures.predicted_uncertainty_percent = largest;
  out.figures.trials = static_cast<std::uint64_t>(std::llround(trials));
  return out;
}

Result<void> predict_times(const Plan& asked, const ExperimentInputs& inputs, PlanPrediction& prediction,
                           std::stop_token stop) {
  const Plan plan = with_frames(asked, inputs);
  TODBENCH_TRY(const auto time, predict_time(plan, inputs, std::move(stop)));
  prediction.figures.predicted_s = time.simulation_s;
  if (plan.camera.id.empty()) return {};
  TODBENCH_TRY(const auto of_camera, predict_plan(as_measured(plan), inputs));
  const BenchTime bench = expected_bench_time(plan, inputs, of_camera);
  prediction.figures.predicted_measurement_s = time.measuring_s + bench.total_s();
  return {};
}

}  // namespace todbench
