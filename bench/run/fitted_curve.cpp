// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/run/fitted_curve.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bench/judgement/run_findings.h"
#include "bench/twin/own_contrasts.h"
#include "tod/adequacy/adequacy.h"

namespace todbench {
TwinShapesOutcome take_shape(TodCurve& curve, std::span<const Trial> trials, bool complete, const Plan& plan,
                             const ExperimentInputs& inputs, const std::map<double, double>& shown_delta_t_k,
                             const TodCurve* known, std::stop_token stop) {
  const ChosenEstimator chosen = chosen_estimator(plan, inputs.sensor);
  const bool by_twin = chosen.estimator == FitEstimator::twin_shape;
  for (TodPoint& point : curve.points) {
    point.estimator_reason = by_twin && !complete ? EstimatorReason::ended_early : chosen.reason;
    point.answers = chosen_answers(plan, inputs.sensor, point.set_delta_t_k);
  }
  TwinShapesOutcome outcome;
  if (by_twin && complete) {
    outcome = fit_twin_shapes(curve, trials, inputs, fit_options(plan),
                              direct_options(curve, inputs, shown_delta_t_k, plan.seed, std::move(stop)), known);
  }
  fit_right_and_wrong(curve, trials, fit_options(plan));
  compare_orientations(curve, trials);
  return outcome;
}

FittedTrials trials_to_fit(const MeasurementResult& run, const Plan& plan, const ExperimentInputs& inputs,
                           const std::stop_token& stop) {
  if (!has_own_contrasts(plan) || run.ended_by || run.trials.empty()) return {};
  auto surface = contrast_surface(plan, inputs, stop);
  if (!surface) return {.failed = surface.error()};
  const double air = run.presentations.empty() ? 1 : run.presentations.front().air_transmittance.value_or(1);
  return {.own = at_set_contrasts(run.trials, *surface, air), .surface = *std::move(surface)};
}

namespace {

/// Takes the thresholds out.
void withhold(TodCurve& curve) {
  for (TodPoint& point : curve.points) {
    point.fit = {};
    point.free_lapse_fit.reset();
    point.lapse_warning = false;
    point.orientations.reset();
  }
}

}  // namespace

std::vector<AdequacyFinding> take_ramp_of(TodCurve& curve, TwinShapesOutcome& said, const MeasurementResult& run,
                                          const FittedTrials& fitted, const Plan& plan) {
  if (plan.schedule.kind != ScheduleKind::ramp) return {};
  if (!fitted.surface || said.ended_by) {
    withhold(curve);
    said.notes.emplace_back(
        "the ramp ended early: its answers belong to contrasts between the set ones, so no threshold is stated");
    return {};
  }
  auto taken = take_ramp(curve, run, *fitted.surface, plan);
  if (!taken) {
    said.ended_by = with_context("the ramp", taken.error());
    return {};
  }
  said.notes.insert(said.notes.end(), taken->notes.begin(), taken->notes.end());
  return std::move(taken->findings);
}

void examine_all(TodCurve& curve, const Plan& plan, const std::vector<AdequacyFinding>& of_all) {
  examine(curve, fit_options(plan));
  for (TodPoint& point : curve.points)
    if (point.adequacy) point.adequacy->findings.insert(point.adequacy->findings.end(), of_all.begin(), of_all.end());
}

void report_fit(const MeasurementResult& result, const Plan& plan, const ExperimentInputs& inputs,
                const OpenSession& open) {
  if (!result.ended_by && chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape)
    phase(open.folder, open.listener, "fitting with the functions of " + inputs.sensor.name);
}

void keep_shape(MeasurementResult& result, const TwinShapesOutcome& outcome, const OpenSession& open) {
  if (!result.ended_by) result.ended_by = outcome.ended_by;
  for (const auto& sentence : outcome.notes) {
    note(open.folder, open.listener, sentence);
    result.notes.push_back(sentence);
  }
}

std::map<double, double> contrasts_seen(const TodCurve& curve) {
  std::map<double, double> seen;
  for (const auto& point : curve.points) seen[point.set_delta_t_k] = point.delta_t_k;
  return seen;
}

namespace {

std::vector<AdequacyFinding> findings_of(const std::vector<ChangedSetting>& changed) {
  std::vector<AdequacyFinding> out;
  for (const ChangedSetting& one : changed)
    out.push_back({FindingKind::setting_change, {}, {}, sentence(one), scales_counts(one.feature)});
  return out;
}

/// Widens the interval if the pictures contradict the model or could not be compared. The half-width of a rectangular
/// distribution is the largest of: the difference between the functions or responses of twin and surrogate, and the
/// effect of another slope.
void widen_where_not_verified(FittedCurve& fitted, const CameraSurrogate& surrogate) {
  if (!surrogate.unconfirmed()) return;
  const double response_shift = surrogate.response_shift();
  for (TodPoint& point : fitted.curve.points) {
    if (surrogate.unseen() && !point.fit.twin_shape) continue;
    double shift = response_shift;
    if (point.fit.twin_shape) shift = std::max(shift, std::abs(point.fit.twin_shape->departure_shift));
    const TodPoint* twin = fitted.by_twin ? point_at(*fitted.by_twin, point.set_delta_t_k) : nullptr;
    if (twin != nullptr && twin->fit.threshold && point.fit.threshold)
      shift = std::max(shift, std::abs(std::log(*point.fit.threshold / *twin->fit.threshold)));
    fitted.model_u[point.set_delta_t_k] = shift / std::sqrt(3.0);
    join_uncertainty(point.fit, fitted.model_u[point.set_delta_t_k], std::nullopt);
  }
}

}  // namespace

std::unique_ptr<BackgroundTask<FittedCurve>> fit_in_background(TodCurve curve, const MeasuredRun& measured,
                                                               const FittedTrials& to_fit, const Plan& plan,
                                                               const ExperimentInputs& inputs,
                                                               BackgroundTwinFunctions* functions,
                                                               const CameraSurrogate& surrogate) {
  const bool complete = !measured.result.ended_by;
  const std::span<const Trial> trials = to_fit.of(measured.result);
  return std::make_unique<BackgroundTask<FittedCurve>>([curve = std::move(curve), complete, trials, &measured, &to_fit,
                                                        &plan, &inputs, functions, &surrogate](std::stop_token stop) {
    TodCurve known;
    if (complete)
      known = functions != nullptr ? functions->known_for(curve, stop) : known_functions(measured.functions, curve);
    FittedCurve fitted{curve, {}};
    fitted.said = take_shape(fitted.curve, trials, complete, plan, inputs, contrasts_seen(curve), &known, stop);
    const auto lent = surrogate.lent();
    if (lent && complete && !fitted.said.ended_by &&
        chosen_estimator(plan, inputs.sensor).estimator == FitEstimator::twin_shape) {
      fitted.by_twin = std::move(fitted.curve);
      fitted.curve = curve;
      fitted.said = take_shape(fitted.curve, trials, complete, plan, *lent, contrasts_seen(curve), nullptr, stop);
    }
    const auto of_ramp = take_ramp_of(fitted.curve, fitted.said, measured.result, to_fit, plan);
    join_contrast_errors(fitted.curve);
    widen_where_not_verified(fitted, surrogate);
    examine_all(fitted.curve, plan, of_ramp);
    if (!fitted.model_u.empty()) {
      const AdequacyFinding finding = surrogate.finding();
      for (TodPoint& point : fitted.curve.points)
        if (point.adequacy && fitted.model_u.contains(point.set_delta_t_k)) point.adequacy->findings.push_back(finding);
    }
    const MeasurementResult& run = measured.result;
    const auto settings = findings_of(measured.changed);
    for (auto& sentence :
         add_run_findings(fitted.curve, plan, {run.presentations, run.contrasts, run.constancy, settings}))
      fitted.said.notes.push_back(std::move(sentence));
    return fitted;
  });
}

}  // namespace todbench
