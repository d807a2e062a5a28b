// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/cost_record.h"

#include "bench/text/json_fields.h"

namespace todbench {
namespace {

void threshold_fields(JsonFields& json, ThresholdEstimate& point) {
  json.value("delta_t_k", point.delta_t_k);
  json.value("s75_pitch", point.s75_pitch);
  json.value("standard_error_pitch", point.standard_error_pitch);
}

void reference_fields(JsonFields& json, CostFrontier& frontier) {
  json.value("wall_s", frontier.reference_s);
  json.value("standard_error_percent", frontier.reference_standard_error_percent);
  json.value("draws", frontier.reference_draws);
  json.value("paired_draws", frontier.paired_draws);
  json.value("points", frontier.reference, threshold_fields);
}

void cost_point_fields(JsonFields& json, CostPoint& point) {
  json.value("knob", point.knob);
  json.value("setting", point.setting);
  json.value("wall_s", point.wall_s);
  json.value("error_percent", point.error_percent);
  json.value("standard_error_percent", point.standard_error_percent);
  json.value("paired", point.paired);
  json.value("chosen", point.chosen);
  json.value("best", point.best);
  json.text_or_null("not_measured", point.not_measured);
}

void cost_fields(JsonFields& json, CostFrontier& frontier) {
  json.value("reference", frontier, reference_fields);
  json.value("points", frontier.points, cost_point_fields);
  json.value("budget_s", frontier.budget_s);
  json.value("spent_s", frontier.spent_s);
  json.value("notes", frontier.notes);
}

}  // namespace

Result<Json> cost_json(const CostFrontier& frontier) {
  return json_of(frontier, cost_fields);
}

Result<CostFrontier> cost_from(const Json& record) {
  return from_json<CostFrontier>(record, cost_fields);
}

}  // namespace todbench
