#include "bench/run/twin_shapes.h"

#include <algorithm>
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

TwinShapesOutcome fit_twin_shapes(TodCurve& curve, std::span<const Trial> trials, const ExperimentInputs& inputs,
                                  const FitOptions& fit, DirectEstimateOptions options) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  options.accuracy.noise_draws = std::max(options.accuracy.noise_draws, twin_shape_draws);
  TwinShapesOutcome outcome;
  for (TodPoint& point : curve.points) {
    const std::string where = "at " + number_text(point.set_delta_t_k) + " K the function is a Weibull function: ";
    const auto curves = proportion_curves(inputs.sensor, inputs.effects, observer, {point.delta_t_k}, options);
    if (!curves) {
      if (curves.error().code == ErrorCode::interrupted) {
        outcome.ended_by = curves.error();
        return outcome;
      }
      outcome.notes.push_back(where + curves.error().message);
      continue;
    }
    std::vector<Trial> own;
    std::ranges::copy_if(trials, std::back_inserter(own),
                         [&](const Trial& trial) { return trial.set_delta_t_k == point.set_delta_t_k; });
    auto fitted =
        fit_twin_shape(graded_answers(own), point.fit, table_of(curves->front(), inputs.sensor.ifov_mrad()), fit);
    if (!fitted) {
      outcome.notes.push_back(where + fitted.error().message);
      continue;
    }
    if (!fitted->twin_shape) {
      outcome.notes.push_back(where + "its fit is not regular (" + std::string(to_string(fitted->verdict)) + ")");
      continue;
    }
    point.fit = *std::move(fitted);
    // Of the Weibull function.
    point.free_lapse_fit.reset();
    point.lapse_warning = false;
  }
  return outcome;
}

}  // namespace todbench
