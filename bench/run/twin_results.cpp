// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/twin_results.h"

#include <algorithm>
#include <utility>

#include "tod/comparison/comparison.h"

namespace todbench {
namespace {

/// Results that the twin adds to a measured curve; its errors end the session early.
struct TwinResults {
  std::optional<RunRecord> run;
  std::optional<TodCurve> curve;
  std::optional<Comparison> comparison;
  std::optional<Error> ended_by;
};

/// Simulates the twin at the contrasts that the camera observed, and compares.
TwinResults run_twin(const Plan& plan, const ExperimentInputs& inputs, const FromCamera& camera,
                     const ExperimentHost& host, const OpenSession& open, std::stop_token stop) {
  phase(open.folder, open.listener, "simulating its twin " + inputs.sensor.name);
  auto twin = run_simulated(plan, inputs, open, SessionCurve::twin, camera, host, std::move(stop));
  TwinResults results;
  if (!twin) {
    results.ended_by = with_context("the simulated twin", twin.error());
    return results;
  }
  results.run = run_record(twin->result, twin->wall_s);
  results.ended_by = twin->result.ended_by;
  results.curve = std::move(twin->curve);
  ComparisonOptions options = comparison_options(plan);
  options.b_shown_contrasts_of_a = true;
  auto comparison = compare(*camera.curve, *results.curve, options);
  if (comparison) {
    results.comparison = std::move(*comparison);
  } else if (!results.ended_by) {
    results.ended_by = with_context("comparing with the simulated twin", comparison.error());
  }
  return results;
}

/// The same by the phases that camera and twin both observed.
void pair_with_twin(ExperimentOutcome& outcome, BackgroundTask<Pairs>& made, const ExperimentInputs& inputs,
                    const OpenSession& open, std::stop_token stop) {
  if (!outcome.comparison || outcome.ended_by) return;
  phase(open.folder, open.listener, "presenting the camera's targets to " + inputs.sensor.name);
  const Pairs& pairs = made.get(std::move(stop));
  Comparison& comparison = *outcome.comparison;
  for (std::size_t i = 0; i < comparison.points.size(); ++i) {
    const auto same = std::ranges::find_if(pairs.ratios.points, [&](const ComparisonPoint& point) {
      return point.paired && same_contrast(point.set_delta_t_k, comparison.points[i].set_delta_t_k);
    });
    if (same != pairs.ratios.points.end()) add_paired(comparison, i, *same->paired);
  }
  for (const auto& sentence : pairs.said.notes) note(open.folder, open.listener, sentence);
  outcome.ended_by = pairs.said.ended_by;
}

/// The measured thresholds with the relative spread of the twin's: both have the same observer.
void take_spread(TodCurve& curve, const TodCurve& twin) {
  for (TodPoint& point : curve.points) {
    const auto same = std::ranges::find_if(
        twin.points, [&](const TodPoint& other) { return same_contrast(other.set_delta_t_k, point.set_delta_t_k); });
    if (same == twin.points.end() || !same->s75_spread_mrad || !same->direct_s75_mrad || !point.fit.threshold) continue;
    const double scale = *point.fit.threshold / *same->direct_s75_mrad;
    point.s75_spread_mrad = {same->s75_spread_mrad->first * scale, same->s75_spread_mrad->second * scale};
  }
}

}  // namespace

void add_twin(ExperimentOutcome& outcome, Provenance& provenance, const FromCamera& camera, const LoadedPlan& loaded,
              const Plan& plan, const ExperimentInputs& inputs, const BackgroundWork& background,
              const ExperimentHost& host, const OpenSession& open, const std::stop_token& stop) {
  TwinResults twin = run_twin(plan, inputs, camera, host, open, stop);
  if (twin.run) outcome.twin_s = twin.run->wall_s;
  provenance.twin_run = std::move(twin.run);
  outcome.twin = std::move(twin.curve);
  if (outcome.twin) take_spread(outcome.curve, *outcome.twin);
  outcome.comparison = std::move(twin.comparison);
  outcome.ended_by = std::move(twin.ended_by);
  if (background.pairs != nullptr) pair_with_twin(outcome, *background.pairs, inputs, open, stop);
  if (outcome.ended_by) return;
  if (outcome.measures) compare_picture(*outcome.measures, loaded, inputs);
  auto measures = background.measures.take(open, stop);
  if (measures)
    outcome.twin_measures = *std::move(measures);
  else
    outcome.ended_by = with_context("the simulated twin", measures.error());
}

}  // namespace todbench
