#include "bench/run/twin_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/text/text.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/twin_shape.h"

namespace todbench {
namespace {

ProportionTable table_of(const ProportionCurve& curve, double ifov_mrad) {
  ProportionTable table{{}, curve.proportion_correct, curve.standard_error};
  for (const double size : curve.sizes_pitch) table.size_mrad.push_back(size * ifov_mrad);
  return table;
}

std::optional<double> error_of(const PsychometricFit& fit) {
  if (!fit.se_ln_threshold) return std::nullopt;
  return *fit.se_ln_threshold * std::sqrt(fit.variance_inflation);
}

Result<ProportionTable> table_at(const TodPoint& point, const ExperimentInputs& inputs, TemplateObserver& observer,
                                 DirectEstimateOptions options, const TodCurve* known) {
  const TodPoint* same = known == nullptr ? nullptr : point_at(*known, point.set_delta_t_k);
  if (same != nullptr && same->fit.twin_shape) return same->fit.twin_shape->table;
  options.accuracy.noise_draws = draws_of_twin_shape(error_of(point.fit), options.accuracy);
  const auto curves = proportion_curves(inputs.sensor, inputs.effects, observer, {point.delta_t_k}, options);
  if (!curves) return tl::unexpected(curves.error());
  return table_of(curves->front(), inputs.sensor.ifov_mrad());
}

}  // namespace

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
  // Of the threshold of a table, by seeds (needed_draws()): 0.331 over the root of the draws where noise of the sensor
  // alone decides, less elsewhere.
  const double needed = std::pow(0.331 / (0.25 * *se_ln_threshold), 2);
  return static_cast<int>(std::clamp<double>(needed, least_twin_shape_draws, most));
}

TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials, const ExperimentInputs& inputs,
                                  const FitOptions& fit, DirectEstimateOptions options, const TodCurve* known) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  TwinShapesOutcome outcome;
  for (TodPoint& point : curve.points) {
    const std::optional<EstimatorReason> reason = point.estimator_reason;
    point.estimator_reason = EstimatorReason::no_function;
    const std::string where = "at " + number_text(point.set_delta_t_k) + " K the function is a Weibull function: ";
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
    std::vector<Trial> own;
    std::ranges::copy_if(trials, std::back_inserter(own),
                         [&](const Trial& trial) { return trial.set_delta_t_k == point.set_delta_t_k; });
    const std::vector<GradedAnswer> answers = graded_answers(own);
    auto fitted = fit_twin_shape(answers, point.fit, *table, fit);
    if (!fitted) {
      outcome.notes.push_back(where + fitted.error().message);
      continue;
    }
    if (!fitted->twin_shape) {
      point.estimator_reason = EstimatorReason::irregular;
      outcome.notes.push_back(where + "its fit is not regular (" + std::string(to_string(fitted->verdict)) + ")");
      continue;
    }
    point.estimator_reason = reason;
    point.fit = *std::move(fitted);
    // Those of the Weibull function are no check of this one.
    point.free_lapse_fit.reset();
    point.lapse_warning = false;
    if (!fit.fixed_lapse) continue;
    const auto free = twin_fit_with_free_lapse(answers, point.fit, fit.form);
    if (!free) continue;
    point.free_lapse_fit = *free;
    point.lapse_warning = twin_lapse_gain(point.fit, *free) > boundary_drop;
  }
  return outcome;
}

}  // namespace todbench
