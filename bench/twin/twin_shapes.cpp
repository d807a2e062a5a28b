// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/twin_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "tod/adequacy/orientation.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

std::optional<double> error_of(const PsychometricFit& fit) {
  if (!fit.se_ln_threshold) return std::nullopt;
  return *fit.se_ln_threshold * std::sqrt(fit.variance_inflation);
}

Result<ProportionTable> table_at(const TodPoint& point, const ExperimentInputs& inputs, TemplateObserver& observer,
                                 DirectEstimateOptions options, const TodCurve* known) {
  const TodPoint* same = known == nullptr ? nullptr : point_at(*known, point.set_delta_t_k);
  if (same != nullptr && same->fit.twin_shape) return same->fit.twin_shape->table;
  options.accuracy.noise_draws = draws_of_twin_shape(error_of(point.fit), options.accuracy);
  TODBENCH_TRY(const auto curves,
               proportion_curves(inputs.sensor, inputs.effects, observer, {point.delta_t_k}, options));
  return table_of(curves.front(), inputs.sensor.ifov_mrad());
}

std::vector<Trial> trials_at(std::span<const Trial> trials, double set_delta_t_k) {
  std::vector<Trial> own;
  std::ranges::copy_if(trials, std::back_inserter(own),
                       [&](const Trial& trial) { return trial.set_delta_t_k == set_delta_t_k; });
  return own;
}

/// Fits a point with the function; returns whether its fit is regular. Errors: those of fit_twin_shape().
Result<bool> give_function(TodPoint& point, std::span<const Trial> trials, const ProportionTable& table,
                           const FitOptions& fit) {
  const std::vector<GradedAnswer> answers = graded_answers(trials_at(trials, point.set_delta_t_k));
  TODBENCH_TRY(auto fitted, fit_twin_shape(answers, point.fit, table, fit));
  if (!fitted.twin_shape) return false;
  point.fit = std::move(fitted);
  // The checks of the Weibull function do not apply to this one.
  point.free_lapse_fit.reset();
  point.lapse_warning = false;
  if (!fit.fixed_lapse) return true;
  const auto free = twin_fit_with_free_lapse(answers, point.fit, fit.form);
  if (!free) return true;
  point.free_lapse_fit = *free;
  point.lapse_warning = twin_lapse_gain(point.fit, *free) > boundary_drop;
  return true;
}

}  // namespace

ProportionTable table_of(const ProportionCurve& curve, double ifov_mrad) {
  ProportionTable table{{}, curve.proportion_correct, curve.standard_error};
  for (const double size : curve.sizes_pitch) table.size_mrad.push_back(size * ifov_mrad);
  return table;
}

DirectEstimateOptions direct_options(const TodCurve& curve, const ExperimentInputs& inputs,
                                     const std::map<double, double>& shown_delta_t_k, std::uint64_t seed,
                                     std::stop_token stop) {
  DirectEstimateOptions options{
      .motion = inputs.motion, .accuracy = inputs.accuracy, .seed = seed, .stop = std::move(stop)};
  for (const auto& point : curve.points) {
    const auto shown = shown_delta_t_k.find(point.set_delta_t_k);
    options.scene_delta_t_k[point.delta_t_k] = shown == shown_delta_t_k.end() ? point.set_delta_t_k : shown->second;
  }
  return options;
}

int draws_of_twin_shape(std::optional<double> se_ln_threshold, const Accuracy& accuracy) {
  const int most = std::max(accuracy.noise_draws, twin_shape_draws);
  if (!se_ln_threshold || !(*se_ln_threshold > 0)) return most;
  // Error of the threshold of a table over seeds (needed_draws()): 0.331 over the root of the draws if only noise of
  // the sensor decides, otherwise less.
  const double needed = std::pow(0.331 / (0.25 * *se_ln_threshold), 2);
  return static_cast<int>(std::clamp<double>(needed, least_twin_shape_draws, most));
}

TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials, const ExperimentInputs& inputs,
                                  const FitOptions& fit, const DirectEstimateOptions& options, const TodCurve* known) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  TwinShapesOutcome outcome;
  for (TodPoint& point : curve.points) {
    const std::optional<EstimatorReason> reason = point.estimator_reason;
    point.estimator_reason = EstimatorReason::no_function;
    const std::string where = "at " + number_text(point.set_delta_t_k) + " K a Weibull function is fitted: ";
    const auto table = table_at(point, inputs, observer, options, known);
    if (!table) {
      if (table.error().code == ErrorCode::interrupted) {
        outcome.ended_by = table.error();
        for (TodPoint& left : curve.points)
          if (!left.fit.twin_shape) left.estimator_reason = EstimatorReason::ended_early;
        return outcome;
      }
      outcome.notes.push_back(where + table.error().message);
      continue;
    }
    const auto regular = give_function(point, trials, *table, fit);
    if (!regular) {
      outcome.notes.push_back(where + regular.error().message);
      continue;
    }
    if (!*regular) {
      point.estimator_reason = EstimatorReason::irregular;
      outcome.notes.push_back(where + "the fit with the twin's function is not regular (" +
                              std::string(to_string(point.fit.verdict)) + ")");
      continue;
    }
    point.estimator_reason = reason;
  }
  return outcome;
}

Result<std::map<double, ProportionTable>> twin_tables(const Plan& plan, const ExperimentInputs& inputs,
                                                      std::optional<double> se_ln_threshold, std::stop_token stop) {
  std::map<double, ProportionTable> tables;
  if (chosen_estimator(plan, inputs.sensor).estimator != FitEstimator::twin_shape) return tables;
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  DirectEstimateOptions options{
      .motion = inputs.motion, .accuracy = inputs.accuracy, .seed = plan.seed, .stop = std::move(stop)};
  options.accuracy.noise_draws = draws_of_twin_shape(se_ln_threshold, inputs.accuracy);
  for (const double delta_t_k : plan.target.delta_t_k) {
    const auto curves = proportion_curves(inputs.sensor, inputs.effects, observer, {delta_t_k}, options);
    if (!curves && curves.error().code == ErrorCode::interrupted) return tl::unexpected(curves.error());
    if (curves) tables[delta_t_k] = table_of(curves->front(), inputs.sensor.ifov_mrad());
  }
  return tables;
}

Result<std::map<double, ProportionTable>> stopping_tables(const Plan& plan, const ExperimentInputs& inputs,
                                                          std::stop_token stop) {
  if (plan.schedule.kind != ScheduleKind::adaptive) return std::map<double, ProportionTable>();
  return twin_tables(plan, inputs, plan.schedule.half_width_percent / 196, std::move(stop));
}

void fit_with_tables(TodCurve& curve, std::span<const Trial> trials, const std::map<double, ProportionTable>& tables,
                     const FitOptions& fit) {
  for (TodPoint& point : curve.points) {
    const auto table = tables.find(point.set_delta_t_k);
    if (table != tables.end()) (void)give_function(point, trials, table->second, fit);
  }
  fit_right_and_wrong(curve, trials, fit);
}

void fit_right_and_wrong(TodCurve& curve, std::span<const Trial> trials, const FitOptions& fit) {
  const auto graded = [](const TodPoint& point) { return !point.fit.twin_shape && is_quasi(point.fit.interval); };
  if (std::ranges::none_of(curve.points, graded)) return;
  const auto binary = tod_curve(as_binary(trials), fit);
  if (!binary) return;
  for (TodPoint& point : curve.points) {
    if (!graded(point)) continue;
    const TodPoint* same = point_at(*binary, point.set_delta_t_k);
    if (same == nullptr) continue;
    point.levels = same->levels;
    point.fit = same->fit;
    point.free_lapse_fit = same->free_lapse_fit;
    point.lapse_warning = same->lapse_warning;
    point.answers = AnswersTaken{AnswerKind::binary, 1, AnswersReason::no_function};
  }
}

void compare_orientations(TodCurve& curve, std::span<const Trial> trials) {
  for (TodPoint& point : curve.points) {
    if (point.fit.twin_shape)
      point.orientations = orientations(trials_at(trials, point.set_delta_t_k), point.fit.twin_shape->table);
  }
}

}  // namespace todbench
