// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/twin/paired_comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "acquisition/base/try.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"
#include "hvs/observer/template_observer.h"
#include "tod/comparison/paired_ratio.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

bool all_graded(std::span<const Trial> trials) {
  return std::ranges::all_of(trials, [](const Trial& trial) { return trial.probability_correct.has_value(); });
}

bool unfit_for_pairs(const TodPoint& point) {
  return point.adequacy && !point.adequacy->adequate();
}

Result<RatioOfPairs> ratio_at(const TodPoint& point, const ContrastScatter& contrast, std::span<const Trial> trials,
                              std::span<const Trial> fitted, double margin_percent, const ExperimentInputs& inputs,
                              TemplateObserver& observer, const PairedTwinOptions& options, const TodPoint* by_twin,
                              double model_u) {
  if (!point.fit.twin_shape)
    return fail(ErrorCode::invalid_input, "the camera's answers are not fitted with the function of the twin");
  if (trials.empty() || !all_graded(trials)) return fail(ErrorCode::invalid_input, "not all answers are graded");
  TODBENCH_TRY(const auto twin, twin_answers(inputs.sensor, inputs.effects, observer, trials, options));
  const std::vector<GradedAnswer> camera = graded_answers(fitted);
  std::vector<PairedAnswer> pairs;
  for (std::size_t i = 0; i < camera.size(); ++i)
    pairs.push_back({camera[i], twin[i].probability_correct, twin[i].variance});
  const TwinShapeUse& use = *point.fit.twin_shape;
  std::optional<OwnFunctions> own;
  if (by_twin != nullptr) {
    const TwinShapeUse& of_twin = *by_twin->fit.twin_shape;
    own.emplace(OwnFunctions{of_twin.table, std::pow(use.shape_se_ln_threshold, 2) +
                                                std::pow(of_twin.shape_se_ln_threshold, 2) + model_u * model_u});
  } else if (model_u > 0) {
    own.emplace(OwnFunctions{use.table, model_u * model_u, use.slope_fitted});
  }
  return paired_ratio(pairs, use.table, use.slope_fitted, options.draws, margin_percent, contrast, own);
}

double model_u_of(const PairedCamera& camera, double set_delta_t_k) {
  if (camera.model_u == nullptr) return 0;
  const auto found = camera.model_u->find(set_delta_t_k);
  return found == camera.model_u->end() ? 0 : found->second;
}

/// The point with the function of the twin; null if the camera's point has it.
Result<const TodPoint*> point_by_twin(const PairedCamera& camera, double set_delta_t_k) {
  if (camera.by_twin == nullptr) return nullptr;
  const TodPoint* found = point_at(*camera.by_twin, set_delta_t_k);
  if (found == nullptr || !found->fit.twin_shape)
    return fail(ErrorCode::invalid_input, "the twin has no psychometric function at this contrast");
  return found;
}

}  // namespace

bool pairs_asked(const Plan& plan, const SensorSpec& sensor) {
  return plan.simulation.paired && chosen_answers(plan, sensor).kind == AnswerKind::graded &&
         chosen_estimator(plan, sensor).estimator == FitEstimator::twin_shape;
}

PairedTwinOptions paired_options(const ExperimentInputs& inputs, std::span<const SetUpRecord> set_ups,
                                 std::uint64_t seed, std::stop_token stop) {
  PairedTwinOptions options{.graded_draws = MeasurementOptions::graded_draws,
                            .motion = inputs.motion,
                            .accuracy = inputs.accuracy,
                            .seed = seed,
                            .stop = std::move(stop)};
  for (const SetUpRecord& set_up : set_ups)
    options.rotations_deg[{set_up.plate, set_up.mounting}] = set_up.registration.rotation_deg;
  return options;
}

PairedOutcome add_paired_ratios(Comparison& comparison, const PairedCamera& camera, const ExperimentInputs& inputs,
                                const PairedTwinOptions& options) {
  TemplateObserver observer(inputs.observer, triangle_alternatives());
  PairedOutcome outcome;
  const std::vector<ContrastScatter> contrasts = contrast_scatter(camera.curve);
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const ComparisonPoint& compared = comparison.points[i];
    const TodPoint* point = point_at(camera.curve, compared.set_delta_t_k);
    if (point == nullptr) continue;
    const auto at_point = [&](std::span<const Trial> trials) {
      std::vector<Trial> own;
      std::ranges::copy_if(trials, std::back_inserter(own),
                           [&](const Trial& trial) { return trial.set_delta_t_k == point->set_delta_t_k; });
      return own;
    };
    const std::vector<Trial> own = at_point(camera.trials);
    const std::vector<Trial> fitted = camera.fitted.empty() ? own : at_point(camera.fitted);
    const ContrastScatter& contrast = contrasts[static_cast<std::size_t>(point - camera.curve.points.data())];
    auto paired = point_by_twin(camera, point->set_delta_t_k).and_then([&](const TodPoint* by_twin) {
      return ratio_at(*point, contrast, own, fitted, compared.margin_percent, inputs, observer, options, by_twin,
                      model_u_of(camera, point->set_delta_t_k));
    });
    if (!paired) {
      if (paired.error().code == ErrorCode::interrupted) {
        outcome.ended_by = paired.error();
        return outcome;
      }
      outcome.notes.push_back("at " + number_text(point->set_delta_t_k) +
                              " K camera and twin are not paired: " + paired.error().message);
      continue;
    }
    if (unfit_for_pairs(*point)) paired->verdict = ComparisonVerdict::inconclusive;
    add_paired(comparison, i, *paired);
  }
  return outcome;
}

std::unique_ptr<BackgroundTask<Pairs>> pairs_in_background(std::function<PairedCamera(std::stop_token)> camera_of,
                                                           const Plan& plan, const ExperimentInputs& inputs) {
  if (!pairs_asked(plan, inputs.sensor)) return nullptr;
  return std::make_unique<BackgroundTask<Pairs>>(
      [camera_of = std::move(camera_of), &plan, &inputs](std::stop_token stop) {
        const PairedCamera camera = camera_of(stop);
        Pairs pairs;
        const double margin = comparison_options(plan).margin_percent;
        for (const TodPoint& point : camera.curve.points)
          pairs.ratios.points.push_back({.set_delta_t_k = point.set_delta_t_k, .margin_percent = margin});
        const PairedTwinOptions options = paired_options(inputs, camera.set_ups, plan.seed, std::move(stop));
        pairs.said = add_paired_ratios(pairs.ratios, camera, inputs, options);
        return pairs;
      });
}

}  // namespace todbench
