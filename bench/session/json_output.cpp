// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/json_output.h"

#include <cmath>

#include "tod/psychometric/acuity.h"

namespace todbench {

Json fit_json(const PsychometricFit& fit) {
  Json json;
  json["verdict"] = to_string(fit.verdict);
  json["threshold"] = json_number(fit.threshold);
  json["ci95"] = json_interval(fit.ci95);
  json["slope"] = json_number(fit.slope);
  json["slope_at_cap"] = fit.slope_at_cap;
  json["lapse"] = json_number(fit.lapse);
  json["log_likelihood"] = json_number(fit.log_likelihood);
  json["deviance"] = json_number(fit.deviance);
  json["degrees_of_freedom"] = fit.degrees_of_freedom;
  json["posterior"] = nullptr;
  if (fit.posterior) {
    Json posterior;
    posterior["median"] = json_number(fit.posterior->median);
    posterior["ci95"] = Json::array({json_number(fit.posterior->low), json_number(fit.posterior->high)});
    posterior["prior_bound"] = fit.posterior->prior_bound;
    json["posterior"] = std::move(posterior);
  }
  return json;
}

Json adequacy_json(const std::optional<Adequacy>& adequacy) {
  if (!adequacy) return nullptr;
  Json json;
  json["adequate"] = adequacy->adequate();
  json["findings"] = Json::array();
  for (const AdequacyFinding& finding : adequacy->findings) {
    Json item;
    item["kind"] = to_string(finding.kind);
    item["value"] = json_number(finding.value);
    item["limit"] = json_number(finding.limit);
    item["sentence"] = finding.sentence;
    item["unfit"] = finding.unfit;
    json["findings"].push_back(std::move(item));
  }
  return json;
}

Json effects_json(const SensorPlan& plan) {
  Json effects = Json::array();
  for (const EffectDecision& decision : plan.decisions) {
    Json effect;
    effect["name"] = to_string(decision.effect);
    effect["decision"] = decision.decision == Decision::simulate ? "simulate" : "skip";
    effect["reason"] = decision.reason;
    effect["predicted_change_percent"] = json_number(decision.predicted_change_percent);
    effects.push_back(std::move(effect));
  }
  return effects;
}

void add_answers(Json& json, const TodPoint& point) {
  const bool said = point.answers.has_value();
  json["answers"] = said ? Json(to_string(point.answers->kind)) : Json(nullptr);
  json["frames_per_presentation"] = said ? Json(point.answers->frames) : Json(nullptr);
  json["answers_reason"] = said ? Json(to_string(point.answers->reason)) : Json(nullptr);
}

Json curve_json(const TodCurve& curve, const SensorPlan& plan, const RunFigures& figures) {
  Json points = Json::array();
  for (const TodPoint& point : curve.points) {
    Json json;
    json["delta_t_k"] = json_number(point.set_delta_t_k);
    json["set_delta_t_k"] = json_number(point.set_delta_t_k);
    json["seen_delta_t_k"] = json_number(point.delta_t_k);
    json["s75_mrad"] = json_number(point.fit.threshold);
    json["s75_ci95_mrad"] = json_interval(point.fit.ci95);
    json["s75_direct_mrad"] = json_number(point.direct_s75_mrad);
    json["s75_direct_se_mrad"] = json_number(point.direct_s75_se_mrad);
    json["acuity_per_mrad"] = json_number(acuity_per_mrad(point.fit));
    json["trials"] = static_cast<std::int64_t>(std::llround(point.fit.trials));
    json["verdict"] = to_string(point.fit.verdict);
    json["estimator"] = to_string(estimator_of(point.fit));
    json["estimator_reason"] = point.estimator_reason ? Json(to_string(*point.estimator_reason)) : Json(nullptr);
    add_answers(json, point);
    json["interval"] = to_string(point.fit.interval);
    json["dispersion"] = json_number(point.fit.dispersion);
    json["clusters"] = json_number(point.fit.clusters);
    json["adequacy"] = adequacy_json(point.adequacy);
    points.push_back(std::move(json));
  }
  Json json;
  json["observer"] = curve.observer;
  json["sensor"] = curve.sensor;
  json["points"] = std::move(points);
  json["plan"] = effects_json(plan);
  json["wall_s"] = json_number(figures.wall_s);
  json["frames"]["used"] = figures.frames_used;
  json["frames"]["rejected"] = Json::object();
  for (const auto& [reason, count] : figures.frames_rejected) json["frames"]["rejected"][reason] = count;
  return json;
}

namespace {

Json paired_json(const RatioOfPairs& paired) {
  Json json;
  json["ratio"] = json_number(paired.ratio);
  json["ratio_ci95"] = json_interval(paired.ci95);
  json["ratio_ci90"] = json_interval(paired.ci90);
  json["se_ln_ratio"] = json_number(paired.se_ln_ratio);
  json["degrees_of_freedom"] = json_number(paired.degrees_of_freedom);
  json["p_difference"] = json_number(paired.p_difference);
  json["p_equivalence"] = json_number(paired.p_equivalence);
  json["verdict"] = to_string(paired.verdict);
  json["interval"] = to_string(paired.interval);
  json["twin_share"] = json_number(paired.twin_share);
  json["draws"] = paired.draws;
  json["pairs"] = paired.answers;
  return json;
}

}  // namespace

Json comparison_json(const Comparison& comparison) {
  Json points = Json::array();
  for (const ComparisonPoint& point : comparison.points) {
    Json json;
    json["delta_t_k"] = json_number(point.set_delta_t_k);
    json["set_delta_t_k"] = json_number(point.set_delta_t_k);
    json["seen_delta_t_k"] = json_number(point.delta_t_a_k);
    json["ratio"] = json_number(point.ratio);
    json["ratio_ci95"] = json_interval(point.ratio_ci95);
    json["p_difference"] = json_number(point.p_difference);
    json["p_equivalence"] = json_number(point.p_equivalence);
    json["margin_percent"] = json_number(point.margin_percent);
    json["verdict"] = to_string(point.verdict);
    if (point.paired) json["paired"] = paired_json(*point.paired);
    points.push_back(std::move(json));
  }
  Json json;
  json["points"] = std::move(points);
  json["verdict"] = to_string(comparison.verdict);
  if (decided_by_pairs(comparison)) json["decided_by"] = "paired";
  if (comparison.adequacy) json["adequacy"] = adequacy_json(comparison.adequacy);
  return json;
}

Json plan_json(const SensorPlan& plan, const PlanFigures& figures) {
  Json json;
  json["effects"] = effects_json(plan);
  json["trials"] = figures.trials;
  json["predicted_uncertainty_percent"] = json_number(figures.predicted_uncertainty_percent);
  json["predicted_s"] = json_number(figures.predicted_s);
  if (figures.predicted_measurement_s) json["predicted_measurement_s"] = json_number(figures.predicted_measurement_s);
  return json;
}

}  // namespace todbench
