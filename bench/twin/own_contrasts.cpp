// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/own_contrasts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/camera_surrogate.h"
#include "bench/twin/twin_shapes.h"
#include "hvs/observer/template_observer.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "tod/measurement/contrast_lag.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/ramp_fit.h"

namespace todbench {
namespace {

constexpr int continuous_points = 41;

std::map<std::int64_t, RampDirection> directions_of(std::span<const Presentation> presentations) {
  std::map<std::int64_t, RampDirection> out;
  const Presentation* before = nullptr;
  RampDirection direction = RampDirection::down;
  for (const Presentation& shown : presentations) {
    const bool new_set_up =
        before == nullptr || before->set.plate != shown.set.plate || before->set.mounting != shown.set.mounting;
    const double change = new_set_up ? -1 : std::abs(shown.set.delta_t_k) - std::abs(before->set.delta_t_k);
    // Both ramps show the last contrast; the second time begins the way back.
    if (change < 0) direction = RampDirection::down;
    if (change > 0) direction = RampDirection::up;
    out[shown.presentation] = direction;
    before = &shown;
  }
  return out;
}

std::vector<RampAnswer> ramp_answers(const MeasurementResult& run) {
  const auto directions = directions_of(run.presentations);
  std::set<std::int64_t> held;  // for the lag only: they would give one set-up more weight than the others
  for (const Presentation& shown : run.presentations)
    if (shown.set.wait == ContrastWait::held) held.insert(shown.presentation);
  const std::vector<GradedAnswer> answers = graded_answers(run.trials);
  std::vector<RampAnswer> out;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (held.contains(run.trials[i].presentation)) continue;
    const auto direction = directions.find(run.trials[i].presentation);
    out.push_back({.answer = answers[i],
                   .delta_t_k = run.trials[i].delta_t_k,
                   .direction = direction == directions.end() ? RampDirection::down : direction->second});
  }
  return out;
}

/// Relative rate of the contrast, 1/s: the largest of that of the plan and the median of that observed.
double relative_rate(std::span<const Presentation> presentations, const RampOptions& ramp) {
  std::vector<double> rates{0};
  const Presentation* before = nullptr;
  for (const Presentation& shown : presentations) {
    if (before != nullptr && before->host_time_ns && shown.host_time_ns && before->delta_t_k && shown.delta_t_k &&
        before->set.plate == shown.set.plate && before->set.mounting == shown.set.mounting) {
      const double seconds = static_cast<double>(*shown.host_time_ns - *before->host_time_ns) * 1e-9;
      const double ratio = *shown.delta_t_k / *before->delta_t_k;
      if (seconds > 0 && ratio > 0) rates.push_back(std::abs(std::log(ratio)) / seconds);
    }
    before = &shown;
  }
  const auto middle = rates.begin() + static_cast<std::ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return std::max(*middle, ramp_relative_rate(ramp));
}

struct RampInterval {
  double ln_s75 = 0, sd = 0;
  double freedom = 1;
  ClusteredVariance variance;

  [[nodiscard]] Interval at(double tail) const {
    const double half = distribution::quantile_above(tail, freedom) * sd;
    return {std::exp(ln_s75 - half), std::exp(ln_s75 + half)};
  }
};

/// The variance of the tables is known from thousands of draws (Satterthwaite).
RampInterval interval_at(const RampFit& fit, const ContrastSurface& surface, double delta_t_k) {
  const RampValue found = fit.at(delta_t_k);
  const double variance = found.variance.variance + std::pow(surface.standard_error(delta_t_k), 2);
  return {.ln_s75 = found.ln_s75,
          .sd = std::sqrt(variance),
          .freedom = found.variance.degrees_of_freedom * std::pow(variance / found.variance.variance, 2),
          .variance = found.variance};
}

void take_value(PsychometricFit& fit, const RampInterval& value, double ln_of_surface) {
  fit.threshold = std::exp(value.ln_s75);
  fit.verdict = fit.verdict == FitVerdict::extrapolated ? FitVerdict::extrapolated : FitVerdict::ok;
  fit.interval = value.variance.kind;
  fit.se_ln_threshold = std::sqrt(value.variance.independent);
  fit.variance_inflation = value.sd * value.sd / value.variance.independent;
  fit.dispersion = value.variance.dispersion;
  fit.clusters = value.freedom + 1;
  fit.ci95 = value.at(0.025);
  fit.ci90 = value.at(0.05);
  if (fit.twin_shape) fit.twin_shape->size_ratio = std::exp(value.ln_s75 - ln_of_surface);
}

void add_direction(RampOutcome& outcome, const RampFit& fit) {
  const auto found = fit.up_against_down();
  if (!found) {
    outcome.notes.emplace_back("the answers do not determine the difference of S75 between ramps up and down");
    return;
  }
  const double percent = 100 * std::expm1(found->ln_up_over_down), limit = 100 * std::expm1(found->limit);
  const std::string sentence =
      fmt::format("S75 of ramps up and down differs by {:+.2f} %, chance allows {:.2f} %", percent, limit);
  outcome.notes.push_back(sentence);
  if (!found->beyond()) return;
  outcome.findings.push_back({.kind = FindingKind::ramp_direction,
                              .value = percent,
                              .limit = limit,
                              .sentence = sentence + ": small and large triangles of the plate do not have the "
                                                     "same contrast while it changes",
                              .unfit = true});
}

/// A lag that the frames show beyond the stated one is not in the interval.
void add_lag(RampOutcome& outcome, std::span<const Presentation> presentations, double stated_s) {
  const auto lag = contrast_lag(presentations, ramp_step_s);
  if (!lag) {
    outcome.notes.emplace_back(
        "the frames of the ramps do not determine the lag of the small triangles: too few of "
        "their presentations have a contrast");
    return;
  }
  const auto text = [](const LagEstimate& one) {
    return fmt::format("{:+.4f} s, chance allows {:.4f} s", one.lag_s, one.chance_s());
  };
  std::string sentence = "the small triangles of the plate change later than the large ones by " + text(lag->all);
  if (lag->down && lag->up)
    sentence += "; against the held contrast by " + text(*lag->down) + " in a ramp down and by " + text(*lag->up) +
                " in a ramp up";
  sentence += fmt::format("; the plan states at most {:.4f} s", stated_s);
  outcome.notes.push_back(sentence);
  const LagEstimate* worst = nullptr;
  for (const LagEstimate* one : {&lag->all, lag->down ? &*lag->down : nullptr, lag->up ? &*lag->up : nullptr})
    if (one != nullptr && one->exceeds(stated_s) && (worst == nullptr || std::abs(one->lag_s) > std::abs(worst->lag_s)))
      worst = one;
  if (worst != nullptr)
    outcome.findings.push_back({.kind = FindingKind::contrast_lag,
                                .value = worst->lag_s,
                                .limit = stated_s,
                                .sentence = sentence,
                                .unfit = true});
}

}  // namespace

Result<ContrastSurface> contrast_surface(const Plan& plan, const ExperimentInputs& inputs, std::stop_token stop) {
  constexpr double beyond = 1.25;
  double strongest = 0, weakest = HUGE_VAL;
  std::vector<double> contrasts = plan.target.delta_t_k;
  if (plan.schedule.kind == ScheduleKind::ramp)
    contrasts.insert(contrasts.end(),
                     {plan.schedule.from_delta_t_k.value_or(0), plan.schedule.to_delta_t_k.value_or(0)});
  for (const double delta_t_k : contrasts) {
    strongest = std::max(strongest, std::abs(delta_t_k));
    weakest = std::min(weakest, std::abs(delta_t_k));
  }
  const ContrastNoise noise{.noise_k = std::max(inputs.sensor.netd_k, 1e-3 * weakest),
                            .internal_noise = inputs.observer.internal_noise};
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  DirectEstimateOptions options{
      .motion = inputs.motion, .accuracy = inputs.accuracy, .seed = plan.seed, .stop = std::move(stop)};
  options.accuracy.noise_draws = draws_of_twin_shape(std::nullopt, inputs.accuracy);
  const auto curves = proportion_curves(inputs.sensor, inputs.effects, observer,
                                        contrasts_of_surface(noise, beyond * strongest, weakest / beyond), options);
  if (!curves) return fail("the function of " + inputs.sensor.name + " over contrast", curves.error());
  std::vector<TableAtContrast> tables;
  for (const ProportionCurve& curve : *curves)
    tables.push_back({curve.delta_t_k, table_of(curve, inputs.sensor.ifov_mrad())});
  return ContrastSurface::of(tables, noise);
}

std::vector<Trial> at_set_contrasts(std::span<const Trial> trials, const ContrastSurface& surface,
                                    double air_transmittance) {
  std::vector<Trial> out(trials.begin(), trials.end());
  std::map<double, double> known;
  const auto ln_threshold = [&](double delta_t_k) {
    const auto [found, is_new] = known.try_emplace(std::abs(delta_t_k));
    if (is_new) found->second = surface.ln_threshold(delta_t_k);
    return found->second;
  };
  for (Trial& trial : out) {
    const double set_k = air_transmittance * trial.set_delta_t_k;
    trial.size_mrad *= std::exp(ln_threshold(set_k) - ln_threshold(trial.delta_t_k));
    trial.delta_t_k = set_k;
  }
  return out;
}

double sensitivity_to_lag(const ContrastSurface& surface, double delta_t_k) {
  constexpr double of_internal_noise = 0.2;
  return std::max(of_internal_noise, std::abs(surface.slope(delta_t_k)));
}

LostContrasts lost_contrasts(std::span<const Presentation> presentations, double ln_step) {
  constexpr double widest = 2.5, certain = 4;
  LostContrasts out;
  const Presentation* before = nullptr;
  for (const Presentation& shown : presentations) {
    ++out.shown;
    if (before != nullptr && before->set.plate == shown.set.plate && before->set.mounting == shown.set.mounting &&
        before->delta_t_k && shown.delta_t_k && *shown.delta_t_k / *before->delta_t_k > 0) {
      const double gap = std::abs(std::log(*shown.delta_t_k / *before->delta_t_k));
      const double error = std::hypot(shown.delta_t_se_k.value_or(0) / *shown.delta_t_k,
                                      before->delta_t_se_k.value_or(0) / *before->delta_t_k);
      if (gap - certain * error > widest * ln_step) out.lost += static_cast<int>(std::lround(gap / ln_step)) - 1;
    }
    before = &shown;
  }
  return out;
}

Result<RampOutcome> take_ramp(TodCurve& curve, const MeasurementResult& run, const ContrastSurface& surface,
                              const Plan& plan) {
  TODBENCH_TRY(auto fit, RampFit::of(ramp_answers(run), surface));
  const RampOptions ramp = ramp_options(plan, {}, 1);
  const double stated_lag_s = plan.target.max_contrast_lag_s.value_or(0);
  const double lag = stated_lag_s * relative_rate(run.presentations, ramp);
  RampOutcome outcome;
  for (TodPoint& point : curve.points) {
    take_value(point.fit, interval_at(fit, surface, point.delta_t_k), surface.ln_threshold(point.delta_t_k));
    const double u = lag * sensitivity_to_lag(surface, point.delta_t_k) / std::numbers::sqrt3;
    join_uncertainty(point.fit, u, std::nullopt);
    point.fit.lag_u = u;
  }
  for (int i = 0; i < continuous_points; ++i) {
    const double delta_t_k = ramp.from_k * std::pow(ramp.to_k / ramp.from_k, i / (continuous_points - 1.0));
    const RampInterval value = interval_at(fit, surface, delta_t_k);
    PsychometricFit one;
    take_value(one, value, 0);
    join_uncertainty(one, lag * sensitivity_to_lag(surface, delta_t_k) / std::numbers::sqrt3, std::nullopt);
    curve.continuous.push_back({delta_t_k, *one.threshold, one.ci95});
  }
  add_direction(outcome, fit);
  add_lag(outcome, run.presentations, stated_lag_s);
  const double ln_step = std::log(ramp.from_k / ramp.to_k) / static_cast<double>(ramp_steps(ramp) - 1);
  if (const LostContrasts lost = lost_contrasts(run.presentations, ln_step); lost.lost > 0)
    outcome.notes.push_back(fmt::format(
        "{} contrasts of the ramps were lost to corrections or other waits, {} were shown", lost.lost, lost.shown));
  return outcome;
}

}  // namespace todbench
