// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <ranges>

#include "acquisition/base/normal.h"
#include "acquisition/base/try.h"
#include "bench/forecast/bench_time.h"
#include "bench/forecast/contrast_forecast.h"
#include "bench/forecast/graded_precision.h"
#include "bench/forecast/ramp_forecast.h"
#include "bench/forecast/time_prediction.h"
#include "bench/forecast/visit_order.h"
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

/// Information of a presentation of each set-up at this contrast, plate by plate, in any unit.
std::vector<double> set_up_information(const Plan& plan, const ExperimentInputs& inputs,
                                       const ContrastOutlook& outlook) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const double slope = std::clamp(outlook.weibull_slope, flattest, steepest);
  std::vector<double> out;
  for (std::size_t i = 0; i < inputs.plates.size(); ++i) {
    double of_plate = 0;
    for (const auto& t : inputs.plates[i].triangles)
      of_plate += information(t.size_mm / plan.target.distance_m, s75_mrad, slope, plan.fit.lapse.value_or(0.01),
                              plan.fit.form);
    out.insert(out.end(), static_cast<std::size_t>(mountings_of(plan.target, i)), of_plate);
  }
  return out;
}

double total(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

/// Number of set-ups by their shares of the information, (sum)^2 / sum of squares; 0 without information.
double effective_number(const std::vector<double>& information) {
  const double squares = std::inner_product(information.begin(), information.end(), information.begin(), 0.0);
  return squares > 0 ? std::pow(total(information), 2) / squares : 0;
}

GradedDesignFigures graded_design(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook,
                                  int frames) {
  const NoiseShares shares = noise_shares(inputs, outlook);
  const auto set_ups = static_cast<int>(set_ups_of(plan.target));
  // A simulated scene changes between two frames.
  const double change_s = plan.target.kind == TargetKind::scene ? 0 : plan.target.shift_change_s;
  return {.sensor_share = shares.sensor,
          .pattern_share = shares.pattern,
          .noise = outlook.q_eff,
          .size_pitch = outlook.s75_pitch,
          .frames = frames,
          .draws = MeasurementOptions::graded_draws,
          .set_ups = set_ups,
          .informative_set_ups = effective_number(set_up_information(plan, inputs, outlook)),
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

/// Adapts the prediction of binary answers to constant stimuli to an adaptive schedule: as many trials as the requested
/// interval needs, or as the cap allows, and at least eight presentations per contrast. The interval includes
/// `of_contrast`, the half-width of ln S75 from the measured contrast.
void adapt_binary(ContrastPrediction& point, const Plan& plan, const std::vector<TargetPlate>& plates,
                  double of_contrast) {
  if (!point.uncertainty_percent || !(point.trials > 0)) return;
  const double per_presentation = triangles_of(plates) / static_cast<double>(plates.size());
  const double asked = plan.schedule.half_width_percent / 100, constant = std::log1p(*point.uncertainty_percent / 100);
  const double of_answers = std::sqrt(std::max(0.0, asked * asked - of_contrast * of_contrast));
  // Beyond the reach of answers it ends after two visits of each set-up.
  const double two_visits = 2.0 * static_cast<double>(set_ups_of(plan.target)) * plan.target.phases * per_presentation;
  const double needed = of_answers > 0 ? std::max(point.trials * std::pow(constant / of_answers, 2),
                                                  least_adaptive_presentations * per_presentation)
                                       : two_visits;
  const double shown = std::min(needed, most_presentations(plan) * per_presentation);
  // Below the cap the schedule continues until the interval itself is narrow enough.
  const bool stops = of_answers > 0 && needed <= shown;
  const double reached = stops ? of_answers : constant * std::sqrt(point.trials / shown);
  if (stops) point.stopped_at_percent = 100 * std::expm1(asked);
  point.uncertainty_percent = 100 * std::expm1(reached);
  point.se_ln_s75 *= reached / constant;
  point.trials = std::round(shown);
}

/// A contrast in a forecast run of an adaptive schedule with graded answers.
struct AdaptiveContrast {
  ContrastPrediction* point = nullptr;
  const ContrastOutlook* outlook =
      nullptr;                      ///< none: no threshold is expected, so that the schedule goes on to its cap
  std::vector<double> information;  ///< of a presentation of each set-up
  GradedDesignFigures all;          ///< every set-up with the phases of the simulation
  double binary_se = 0;             ///< of that design
  double slope = 0;                 ///< of ln S75 over ln contrast; 0: the contrast is no part of the interval
  std::vector<int> shown;           ///< presentations in each set-up
  std::vector<int> looks;           ///< measurements of the contrast in each set-up
  int presentations = 0;
  bool settled = false;
};

/// Sets the prediction of a contrast after the presentations shown. Returns whether the expected interval is narrow
/// enough for the schedule, or cannot become so (AdaptiveSchedule).
bool narrow_enough(AdaptiveContrast& contrast, const Plan& plan, const ExperimentInputs& inputs) {
  std::vector<double> seen = contrast.information;
  for (std::size_t i = 0; i < seen.size(); ++i) seen[i] *= contrast.shown[i];
  GradedDesignFigures design = contrast.all;
  design.informative_set_ups = effective_number(seen);
  design.set_ups = static_cast<int>(std::ranges::count_if(contrast.shown, [](int n) { return n > 0; }));
  design.presentations = contrast.presentations;
  const double share = total(seen) / (total(contrast.information) * plan.simulation.phases);
  predict_graded(*contrast.point, plan, inputs, design, contrast.outlook->q_eff, contrast.binary_se / std::sqrt(share));
  if (contrast.presentations < least_adaptive_presentations) return false;
  const double asked = plan.schedule.half_width_percent / 100;
  const double of_contrast =
      contrast.slope > 0 ? contrast_half_width(plan, inputs, contrast.point->delta_t_k, contrast.looks, contrast.slope)
                         : 0;
  const bool reached = std::hypot(contrast.point->interval_factor * contrast.point->se_ln_s75, of_contrast) <= asked;
  if (reached) contrast.point->stopped_at_percent = 100 * std::expm1(asked);
  return reached || (of_contrast >= asked && std::ranges::all_of(contrast.looks, [](int looks) { return looks > 1; }));
}

/// Goes through the visits of an adaptive schedule with graded answers until every contrast is expected to have the
/// requested interval, or until its cap, and sets the predictions of the contrasts, the highest first.
void run_adaptively(std::vector<AdaptiveContrast>& contrasts, const Plan& plan, const ExperimentInputs& inputs) {
  const int phases = plan.camera.id.empty() ? plan.simulation.phases : plan.target.phases;
  VisitOrder order(plan, numbered_set_ups(plan, inputs.plates.size()));
  int left = plan.schedule.max_presentations;
  std::optional<std::size_t> before;
  while (left > 0) {
    const auto open = std::ranges::count(contrasts, false, &AdaptiveContrast::settled);
    if (open == 0) break;
    const std::size_t set_up = order.next(static_cast<int>(open));
    const bool looks = before != set_up;
    before = set_up;
    for (AdaptiveContrast& contrast : contrasts) {
      if (looks && !contrast.settled) ++contrast.looks[set_up];
      for (int phase = 0; phase < phases && left > 0 && !contrast.settled; ++phase, --left) {
        ++contrast.shown[set_up];
        ++contrast.presentations;
        contrast.settled = contrast.outlook != nullptr && narrow_enough(contrast, plan, inputs);
      }
    }
  }
  const double per_presentation = triangles_of(inputs.plates) / static_cast<double>(inputs.plates.size());
  for (AdaptiveContrast& contrast : contrasts) {
    contrast.point->trials = std::round(contrast.presentations * per_presentation);
    if (const auto stopped = contrast.point->stopped_at_percent) contrast.point->uncertainty_percent = stopped;
  }
}

/// Standard error of ln S75 of binary answers of constant stimuli; empty if the sizes do not identify a threshold.
std::optional<double> binary_error(const Plan& plan, const ExperimentInputs& inputs, const ContrastOutlook& outlook) {
  const double s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const auto design = design_at(levels_of(plan, inputs.plates), plan.fit.form, s75_mrad,
                                std::clamp(outlook.weibull_slope, flattest, steepest), plan.fit.lapse.value_or(0.01));
  const auto fit = expected_fit(design, fit_options(plan));
  return fit ? std::optional(fit->se_ln_threshold) : std::nullopt;
}

void predict_interval(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs,
                      const ContrastOutlook& outlook) {
  point.s75_mrad = outlook.s75_pitch * inputs.sensor.ifov_mrad();
  const auto binary_se = binary_error(plan, inputs, outlook);
  if (!binary_se) return;
  if (chosen_answers(plan, inputs.sensor).kind == AnswerKind::graded) {
    const int frames = chosen_answers(plan, inputs.sensor, outlook.delta_t_k).frames;
    predict_graded(point, plan, inputs, graded_design(plan, inputs, outlook, frames), outlook.q_eff, *binary_se);
    return;
  }
  predict_binary(point, plan, inputs, outlook, *binary_se);
}

/// A contrast before the forecast run.
AdaptiveContrast begun(ContrastPrediction& point, const Plan& plan, const ExperimentInputs& inputs, double slope) {
  const std::size_t set_ups = numbered_set_ups(plan, inputs.plates.size()).size();
  AdaptiveContrast contrast;
  contrast.point = &point;
  contrast.slope = slope;
  contrast.shown.resize(set_ups);
  contrast.looks.resize(set_ups);
  const auto outlook = std::ranges::find(inputs.outlooks, point.delta_t_k, &ContrastOutlook::delta_t_k);
  const auto error = outlook != inputs.outlooks.end() ? binary_error(plan, inputs, *outlook) : std::nullopt;
  if (!error) return contrast;
  contrast.outlook = &*outlook;
  contrast.information = set_up_information(plan, inputs, *outlook);
  contrast.all = graded_design(plan, inputs, *outlook, chosen_answers(plan, inputs.sensor, point.delta_t_k).frames);
  contrast.binary_se = *error;
  return contrast;
}

/// Replaces the predictions of constant stimuli by those of an adaptive schedule. Returns the measurements of each
/// contrast of the plan in each set-up (contrast_half_width()).
std::vector<std::vector<int>> adapt(std::vector<ContrastPrediction>& points, const Plan& plan,
                                    const ExperimentInputs& inputs) {
  const std::size_t set_ups = numbered_set_ups(plan, inputs.plates.size()).size();
  std::vector<std::vector<int>> looks(points.size(),
                                      std::vector<int>(set_ups, has_own_contrasts(plan) ? plan.simulation.phases : 1));
  if (plan.schedule.kind != ScheduleKind::adaptive || set_ups == 0) return looks;
  const bool joined = !plan.camera.id.empty();
  const std::vector<double> slopes =
      joined ? expected_contrast_effects(points) : std::vector<double>(points.size(), 0.0);
  if (chosen_answers(plan, inputs.sensor).kind != AnswerKind::graded) {
    for (std::size_t i = 0; i < points.size(); ++i)
      adapt_binary(points[i], plan, inputs.plates,
                   joined ? contrast_half_width(plan, inputs, points[i].delta_t_k, looks[i], slopes[i]) : 0);
    return looks;
  }
  std::vector<AdaptiveContrast> contrasts;
  for (std::size_t i = 0; i < points.size(); ++i) contrasts.push_back(begun(points[i], plan, inputs, slopes[i]));
  std::ranges::stable_sort(contrasts, std::greater<>(),
                           [](const AdaptiveContrast& c) { return std::abs(c.point->delta_t_k); });
  run_adaptively(contrasts, plan, inputs);
  for (AdaptiveContrast& contrast : contrasts)
    looks[static_cast<std::size_t>(contrast.point - points.data())] = std::move(contrast.looks);
  return looks;
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
      chosen.back() = cheapest_frames(graded_design(plan, inputs, *outlook, 1), single_s, 1 / rate_hz);
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

std::vector<double> expected_presentations(const Plan& plan, const std::vector<TargetPlate>& plates,
                                           const std::vector<ContrastPrediction>& contrasts) {
  const double triangles = triangles_of(plates);
  if (plan.schedule.kind != ScheduleKind::adaptive || !(triangles > 0)) return {};
  std::vector<double> out;
  for (const auto& contrast : contrasts)
    out.push_back(contrast.trials * static_cast<double>(plates.size()) / triangles);
  return out;
}

BenchTime expected_bench_time(const Plan& plan, const ExperimentInputs& inputs,
                              const std::vector<ContrastPrediction>& contrasts) {
  return bench_time(plan, inputs.plates, inputs.sensor.frame_rate_hz,
                    expected_presentations(plan, inputs.plates, contrasts));
}

Result<PlanPrediction> predict_plan(const Plan& asked, const ExperimentInputs& inputs) {
  const Plan plan = with_frames(asked, inputs);
  if (auto none = refuse_modules(plan, inputs.sensor); !none) return tl::unexpected(none.error());
  if (auto met = reachable(plan, inputs); !met) return tl::unexpected(met.error());

  PlanPrediction out{.figures = {}, .contrasts = {}, .warnings = inputs.warnings};
  for (std::size_t i = 0; const ContrastDesign& design : contrast_designs(plan, inputs)) {
    const double delta_t_k = plan.target.delta_t_k[i++];
    ContrastPrediction point{.delta_t_k = delta_t_k, .s75_mrad = std::nullopt, .uncertainty_percent = std::nullopt};
    for (const auto& level : levels_of(design.plan, inputs.plates)) point.trials += level.total;
    point.trials *= design.shown / design.plan.simulation.phases;
    const auto outlook = std::ranges::find(inputs.outlooks, delta_t_k, &ContrastOutlook::delta_t_k);
    std::string saturated = beyond_range(inputs.sensor, delta_t_k);
    if (outlook != inputs.outlooks.end() && saturated.empty())
      predict_interval(point, design.plan, inputs, *outlook);
    else if (!saturated.empty())
      out.warnings.push_back(std::move(saturated));
    out.contrasts.push_back(point);
  }
  const auto looks = adapt(out.contrasts, plan, inputs);
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
  const BenchTime bench = expected_bench_time(plan, inputs, of_camera.contrasts);
  prediction.figures.predicted_measurement_s = time.measuring_s + bench.total_s();
  return {};
}

}  // namespace todbench
