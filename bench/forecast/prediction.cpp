// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/prediction.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <ranges>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/ramp_forecast.h"
#include "bench/forecast/time_prediction.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "bench/twin/module_chain.h"
#include "bench/twin/paired_comparison.h"
#include "bench/twin/twin_shapes.h"
#include "sim_devices/prediction/direct_timing.h"
#include "tod/comparison/planning.h"
#include "tod/plate/test_pattern.h"
#include "tod/schedule/adaptive_schedule.h"

namespace todbench {
namespace {

// Weibull slopes of the searching observer: 2.8 (noise dominates) to 6.5 (microscan, no noise). The first tier finds
// them within a quarter, except without noise, where its function has steps.
constexpr double flattest = 2.5, steepest = 6;

// Intervals of runs over that of the expected counts: 1.03 +- 0.07, because answers scatter and trials of one
// presentation or place are slightly dependent. 95 % of runs stay below 1.2 (asked_uncertainty_study).
constexpr double likely_excess = 1.2, mean_excess = 1.03;

/// Trials per size at one contrast.
std::vector<Level> levels_of(const Plan& plan, const std::vector<TargetPlate>& plates) {
  std::map<double, double> totals;
  for (std::size_t i = 0; i < plates.size(); ++i) {
    for (const auto& t : plates[i].triangles)
      totals[t.size_mm / plan.target.distance_m] +=
          static_cast<double>(mountings_of(plan.target, i)) * plan.simulation.phases;
  }
  std::vector<Level> levels;
  for (const auto& [size, total] : totals)
    levels.push_back({.size = size, .correct = 0, .total = total, .cluster = -1});
  return levels;
}

/// Shares in the variance of the noise that decides an answer at a contrast.
struct NoiseShares {
  double sensor = 0;   ///< noise of the sensor, not of the observer
  double pattern = 0;  ///< its fixed pattern, which q_eff does not include
};

NoiseShares noise_shares(const ExperimentInputs& inputs, const ContrastOutlook& outlook) {
  const TemplateObserverSpec& observer = inputs.observer;
  const double white = outlook.q_eff * outlook.q_eff, own = outlook.observer_variance;
  const double factor = observer.sensor_noise_factor * observer.sensor_noise_factor;
  const double pattern =
      std::pow(inputs.sensor.samples_per_pitch() * inputs.sensor.fixed_pattern_k / outlook.delta_t_k, 2);
  const double all = white + pattern;
  return {(std::max(0.0, white - own) / factor + pattern) / all, pattern / all};
}

/// Relative standard error of the threshold of a table of proportions (needed_draws(), twin_shapes.h), for answers with
/// this standard error.
double se_of_shape(const Accuracy& accuracy, double q_eff, std::optional<double> se_ln_threshold) {
  return (0.046 + 0.285 * q_eff) / std::sqrt(draws_of_twin_shape(se_ln_threshold, accuracy));
}

/// Information about the threshold of a trial of this size, in any unit.
double information(double size, double threshold, double slope, double lapse, PsychometricForm form) {
  const Level level{.size = size, .correct = 0, .total = 1, .cluster = -1};
  const auto at = [&](double stretched) {
    return design_at({&level, 1}, form, stretched, slope, lapse).front().proportion_correct;
  };
  constexpr double step = 1e-3;
  const double p = at(threshold), change = at(threshold * (1 + step)) - p;
  return p > 0 && p < 1 ? change * change / (p * (1 - p)) : 0;
}

/// Number of set-ups by their shares of the information at this contrast.
double informative_set_ups(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const double slope = std::clamp(outlook.weibull_slope, flattest, steepest);
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < inputs.plates.size(); ++i) {
    double of_plate = 0;
    for (const auto& t : inputs.plates[i].triangles)
      of_plate += information(t.size_mm / plan.target.distance_m, s75_mrad, slope, plan.fit.lapse.value_or(0.01),
                              plan.fit.form);
    const auto mountings = static_cast<double>(mountings_of(plan.target, i));
    sum += mountings * of_plate;
    squares += mountings * of_plate * of_plate;
  }
  return squares > 0 ? sum * sum / squares : 0;
}

GradedDesignFigures graded_design(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook,
                                  int frames) {
  const NoiseShares shares = noise_shares(inputs, outlook);
  const auto set_ups = static_cast<int>(set_ups_of(plan.target));
  // A simulated scene changes between two frames.
  const double change_s = plan.target.kind == TargetKind::scene ? 0 : plan.target.shift_change_s;
  return {.sensor_share = shares.sensor,
          .pattern_share = shares.pattern,
          .size_pitch = outlook.s75_pitch,
          .frames = frames,
          .draws = MeasurementOptions::graded_draws,
          .set_ups = set_ups,
          .informative_set_ups = informative_set_ups(plan, inputs, outlook),
          .presentations = set_ups * plan.simulation.phases,
          .noise_correlation = inputs.sensor.noise_correlation,
          .frames_between = change_s * inputs.sensor.frame_rate_hz};
}

/// Sets the interval of ln S75 of graded answers of a design, from the standard error of as many binary ones.
void predict_graded(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                    const GradedDesignFigures& design, double q_eff, double binary_se) {
  const double se = std::hypot(binary_se * std::sqrt(graded_variance_ratio(design)),
                               se_of_shape(inputs.accuracy, q_eff, std::nullopt));
  const double factor = graded_interval_factor(design);
  point.uncertainty_percent = 100 * std::expm1(factor * se);
  point.se_ln_s75 = se;
  point.degrees_of_freedom = graded_freedom(design);
  point.interval_factor = factor / graded_likely_excess(design);
  if (!pairs_asked(plan, inputs.sensor)) return;
  point.paired_se_ln_ratio =
      factor / normal_z95 * binary_se * std::sqrt(paired_variance_ratio(design, PairedTwinOptions::default_draws));
}

/// The same for binary answers.
void predict_binary(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                    const ContrastOutlook& outlook, double binary_se) {
  const bool by_twin = chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape;
  const double of_shape = by_twin ? se_of_shape(inputs.accuracy, outlook.q_eff, binary_se) : 0;
  const double inflation = pattern_inflation(graded_design(plan, inputs, outlook, 1));
  const double se = std::hypot(binary_se * std::sqrt(inflation), of_shape);
  point.uncertainty_percent = 100 * std::expm1(likely_excess * normal_z95 * se);
  point.se_ln_s75 = se;
  point.interval_factor = mean_excess * normal_z95;
}

/// Largest number of presentations per contrast of an adaptive schedule.
int most_presentations(const Plan& plan) {
  return std::max(plan.schedule.max_presentations / static_cast<int>(plan.target.delta_t_k.size()), 1);
}

/// Design of the first presentations at a contrast of an adaptive schedule, which visits one set-up after the other.
GradedDesignFigures after_presentations(GradedDesignFigures design, int presentations, int phases_of_visit) {
  const int visited = std::clamp((presentations + phases_of_visit - 1) / phases_of_visit, 1, design.set_ups);
  design.informative_set_ups *= static_cast<double>(visited) / design.set_ups;
  design.set_ups = visited;
  design.presentations = presentations;
  return design;
}

/// Adapts the prediction of binary answers to constant stimuli to an adaptive schedule: as many trials as the requested
/// interval needs, or as the cap allows, and at least eight presentations per contrast.
void adapt(ContrastPrediction& point, const Plan& plan, const std::vector<TargetPlate>& plates) {
  if (plan.schedule.kind != ScheduleKind::adaptive || !point.uncertainty_percent || !(point.trials > 0)) return;
  double triangles = 0;
  for (const auto& plate : plates) triangles += static_cast<double>(plate.triangles.size());
  const double per_presentation = triangles / static_cast<double>(plates.size());
  const double asked = plan.schedule.half_width_percent / 100, constant = std::log1p(*point.uncertainty_percent / 100);
  const double needed =
      std::max(point.trials * std::pow(constant / asked, 2), least_adaptive_presentations * per_presentation);
  const double cap = most_presentations(plan) * per_presentation;
  // Below the cap the schedule continues until the interval itself is narrow enough.
  const double reached = needed <= cap ? asked : constant * std::sqrt(point.trials / cap);
  point.uncertainty_percent = 100 * std::expm1(reached);
  point.se_ln_s75 *= reached / constant;
  point.trials = std::round(std::min(needed, cap));
}

/// The prediction of graded answers. An adaptive schedule goes on until the interval is narrow enough. After few
/// set-ups the factor of the interval is larger, and the phases do not cancel yet. Once all set-ups are visited, the
/// interval only becomes narrower.
void predict_graded_schedule(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                             const ContrastOutlook& outlook, double binary_se) {
  const int frames = chosen_answers(plan, inputs.sensor, outlook.delta_t_k).frames;
  const GradedDesignFigures all = graded_design(plan, inputs, outlook, frames);
  predict_graded(point, plan, inputs, all, outlook.q_eff, binary_se);
  if (plan.schedule.kind != ScheduleKind::adaptive) return;
  const double trials = point.trials, asked = plan.schedule.half_width_percent / 100;
  const int phases = plan.camera.id.empty() ? plan.simulation.phases : plan.target.phases;
  const int cap = most_presentations(plan), all_visited = std::min(cap, all.set_ups * phases);
  const auto narrow_after = [&](int presentations) {
    const double share = static_cast<double>(presentations) / all.presentations;
    predict_graded(point, plan, inputs, after_presentations(all, presentations, phases), outlook.q_eff,
                   binary_se / std::sqrt(share));
    point.trials = std::round(trials * share);
    return point.interval_factor * point.se_ln_s75 <= asked;
  };
  int needed = std::min(least_adaptive_presentations, cap);
  while (needed < all_visited && !narrow_after(needed)) ++needed;
  if (needed >= all_visited) {
    // The smallest number that is enough; the cap if none is.
    for (int enough = cap; needed < enough;) {
      const int middle = needed + (enough - needed) / 2;
      if (narrow_after(middle)) {
        enough = middle;
      } else {
        needed = middle + 1;
      }
    }
  }
  if (narrow_after(needed)) point.uncertainty_percent = 100 * std::expm1(asked);
}

void predict_interval(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                      const std::vector<Level>& levels, const ContrastOutlook& outlook) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const auto design = design_at(levels, plan.fit.form, s75_mrad, std::clamp(outlook.weibull_slope, flattest, steepest),
                                plan.fit.lapse.value_or(0.01));
  const auto fit = expected_fit(design, fit_options(plan));
  if (!fit) return;
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded) {
    predict_graded_schedule(point, plan, inputs, outlook, fit->se_ln_threshold);
    return;
  }
  predict_binary(point, plan, inputs, outlook, fit->se_ln_threshold);
  adapt(point, plan, inputs.plates);
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
    const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
    const double slope = std::clamp(outlook.weibull_slope, flattest, steepest);
    double sum = 0;
    for (std::size_t i = 0; i < inputs.plates.size(); ++i) {
      for (const auto& t : inputs.plates[i].triangles)
        sum += static_cast<double>(mountings_of(plan.target, i)) *
               information(t.size_mm / plan.target.distance_m, s75_mrad, slope, plan.fit.lapse.value_or(0.01),
                           plan.fit.form);
    }
    const int frames = chosen_answers(plan, inputs.sensor, outlook.delta_t_k).frames;
    const double ratio = graded_variance_ratio(graded_design(plan, inputs, outlook, frames));
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

}  // namespace

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
  const BenchTime time = bench_time(single, inputs.plates, rate_hz, std::nullopt);
  const double single_s = time.total_s() / std::max(1.0, static_cast<double>(time.presentations));
  std::vector<int> chosen;
  for (const double delta_t_k : plan.target.delta_t_k) {
    chosen.push_back(chosen_answers(plan, inputs.sensor, delta_t_k).frames);
    const auto outlook = std::ranges::find(inputs.outlooks, delta_t_k, &ContrastOutlook::delta_t_k);
    if (frames_at(plan, delta_t_k) == 0 && single_s > 0 && rate_hz > 0 && outlook != inputs.outlooks.end())
      chosen.back() = cheapest_frames(graded_design(plan, inputs, *outlook, 1), single_s, 1 / rate_hz);
  }
  const bool same = std::ranges::all_of(chosen, [&](int n) { return n == chosen[0]; });
  frames = same && !chosen.empty() ? std::vector<int>{chosen[0]} : chosen;
  return plan;
}

std::optional<double> expected_presentations(const Plan& plan, const std::vector<TargetPlate>& plates,
                                             const std::vector<ContrastPrediction>& contrasts) {
  if (plan.schedule.kind != ScheduleKind::adaptive || contrasts.empty() || plates.empty()) return std::nullopt;
  double triangles = 0, trials = 0;
  for (const auto& plate : plates) triangles += static_cast<double>(plate.triangles.size());
  for (const auto& contrast : contrasts) trials += contrast.trials;
  return triangles > 0 ? std::optional(trials * static_cast<double>(plates.size()) / triangles) : std::nullopt;
}

Result<PlanPrediction> predict_plan(const Plan& asked, const ExperimentInputs& inputs) {
  const Plan plan = with_frames(asked, inputs);
  if (auto none = refuse_modules(plan, inputs.sensor); !none) return tl::unexpected(none.error());
  if (auto met = reachable(plan, inputs); !met) return tl::unexpected(met.error());

  PlanPrediction out{.figures = {}, .contrasts = {}, .warnings = inputs.warnings};
  const std::vector<ContrastDesign> designs = contrast_designs(plan, inputs);
  double trials = 0;
  bool all_identified = true;
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const double delta_t_k = plan.target.delta_t_k[i];
    const auto levels = levels_of(designs[i].plan, inputs.plates);
    ContrastPrediction point{.delta_t_k = delta_t_k, .s75_mrad = std::nullopt, .uncertainty_percent = std::nullopt};
    for (const auto& level : levels) point.trials += level.total;
    point.trials *= designs[i].shown / designs[i].plan.simulation.phases;
    for (const auto& outlook : inputs.outlooks) {
      if (outlook.delta_t_k != delta_t_k) continue;
      point.s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
      predict_interval(point, designs[i].plan, inputs, levels, outlook);
    }
    trials += point.trials;
    if (point.uncertainty_percent) {
      out.figures.predicted_uncertainty_percent =
          std::max(out.figures.predicted_uncertainty_percent.value_or(0), *point.uncertainty_percent);
    } else {
      all_identified = false;
      out.warnings.push_back("at " + number_text(delta_t_k) + " K the sizes of the plates do not identify a threshold");
    }
    out.contrasts.push_back(point);
  }
  if (!all_identified) out.figures.predicted_uncertainty_percent.reset();
  out.figures.trials = static_cast<std::uint64_t>(std::llround(trials));
  return out;
}

Result<void> predict_times(const Plan& asked, const ExperimentInputs& inputs, PlanPrediction& prediction,
                           std::stop_token stop) {
  const Plan plan = with_frames(asked, inputs);
  TODBENCH_TRY(const auto time, predict_time(plan, inputs, std::move(stop)));
  prediction.figures.predicted_s = time.simulation_s;
  if (plan.camera.id.empty()) return {};
  const auto presentations = expected_presentations(plan, inputs.plates, prediction.contrasts);
  const BenchTime bench = bench_time(plan, inputs.plates, inputs.sensor.frame_rate_hz, presentations);
  prediction.figures.predicted_measurement_s = time.measuring_s + bench.total_s();
  return {};
}

}  // namespace todbench
