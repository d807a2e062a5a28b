// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/json_output.h"

#include <cmath>

#include "bench/session/fit_record.h"
#include "bench/text/spread_text.h"
#include "tod/psychometric/acuity.h"

namespace todbench {

namespace {

/// Adds "answers", "frames_per_presentation" and "answers_reason" of a point; null if unknown.
void add_answers(Json& json, const TodPoint& point) {
  const bool said = point.answers.has_value();
  json["answers"] = said ? Json(to_string(point.answers->kind)) : Json(nullptr);
  json["frames_per_presentation"] = said ? Json(point.answers->frames) : Json(nullptr);
  json["answers_reason"] = said ? Json(to_string(point.answers->reason)) : Json(nullptr);
}

}  // namespace

Json curve_json(const TodCurve& curve, const SensorPlan& plan, const RunFigures& figures) {
  Json points = Json::array();
  for (const TodPoint& point : curve.points) {
    Json json;
    json["delta_t_k"] = json_number(point.set_delta_t_k);
    json["set_delta_t_k"] = json_number(point.set_delta_t_k);
    json["seen_delta_t_k"] = json_number(point.delta_t_k);
    json["s75_mrad"] = json_number(stated_threshold(point.fit));
    json["s75_ci95_mrad"] = json_interval(point.fit.ci95);
    json["s75_direct_mrad"] = json_number(point.direct_s75_mrad);
    json["s75_direct_se_mrad"] = json_number(point.direct_s75_se_mrad);
    add_spread(json, "s75_spread_mrad", point.s75_spread_mrad);
    json["acuity_per_mrad"] = json_number(stated_acuity_per_mrad(point.fit));
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
  if (!curve.continuous.empty()) {
    json["curve"] = Json::array();
    for (const ContinuousPoint& point : curve.continuous)
      json["curve"].push_back({{"delta_t_k", json_number(point.delta_t_k)},
                               {"s75_mrad", json_number(point.s75_mrad)},
                               {"s75_ci95_mrad", json_interval(point.ci95)}});
  }
  json["plan"] = effects_json(plan);
  json["wall_s"] = json_number(figures.wall_s);
  json["frames"]["used"] = figures.frames_used;
  json["frames"]["rejected"] = Json::object();
  for (const auto& [reason, count] : figures.frames_rejected) json["frames"]["rejected"][reason] = count;
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
