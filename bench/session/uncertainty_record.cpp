// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/uncertainty_record.h"

#include "bench/text/json_fields.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

void applied_fields(JsonFields& json, AppliedRow& applied) {
  BudgetRow& row = applied.row;
  std::string stated_by = applied.from_run ? "run" : "plan";
  json.value("name", row.name);
  json.value("enters", applied.input, budget_inputs);
  json.value("stated_by", stated_by);
  json.value("value", row.value);
  json.value("unit", row.unit);
  json.value("distribution", row.distribution, budget_distributions);
  json.value("coverage_factor", row.coverage_factor);
  json.value("degrees_of_freedom", row.degrees_of_freedom);
  json.value("sensitivity", row.sensitivity);
  json.value("standard_uncertainty", applied.standard_uncertainty);
  json.value("contribution", applied.contribution);
  json.value("share_percent", applied.share_percent);
  json.value("source", row.source);
  json.value("certificate", row.certificate);
  json.value("common", row.common, budget_commons);
  row.enters = applied.input;
  applied.from_run = stated_by == "run";
}

void expanded_ratio_fields(JsonFields& json, ExpandedRatio& ratio) {
  json.value("expanded95", ratio.ci95);
  json.value("expanded90", ratio.ci90);
}

void point_uncertainty_fields(JsonFields& json, PointUncertainty& point) {
  using Combined = CombinedUncertainty;
  json.value("delta_t_k", point.set_delta_t_k);
  json.value("contrast_slope", point.contrast_slope);
  json.begin("u_ln_acuity", point.combined);
  json.member("u_ln_acuity", point.combined, &Combined::u);
  json.member("nu_eff", point.combined, &Combined::nu_eff);
  json.member("k", point.combined, &Combined::k);
  json.member("expanded_gum", point.combined, &Combined::expanded_gum);
  json.member("expanded_monte_carlo", point.combined, &Combined::expanded_monte_carlo);
  json.member("expanded", point.combined, &Combined::expanded);
  json.value("u_stated", point.u_stated);
  json.value("u_not_common_to_twin", point.u_not_twin);
  json.value("u_not_common_to_series", point.u_not_series);
  json.value("u_not_common_to_contrasts", point.u_not_contrasts);
  json.value("s75_ci95_mrad", point.statistical_mrad);
  json.value("s75_expanded95_mrad", point.expanded_mrad);
  json.derived("acuity_ci95_per_mrad", json_interval(acuity_interval(point.statistical_mrad)));
  json.derived("acuity_expanded95_per_mrad", json_interval(acuity_interval(point.expanded_mrad)));
  json.value("ratio", point.ratio, expanded_ratio_fields);
  json.value("rows", point.rows, applied_fields);
  if (!json.reading() || !point.combined) return;
  for (const AppliedRow& row : point.rows)
    point.combined->shares.push_back({row.standard_uncertainty, row.contribution, row.share_percent});
}

void uncertainty_fields(JsonFields& json, CurveUncertainty& uncertainty) {
  json.value("points", uncertainty.points, point_uncertainty_fields);
  json.value("not_stated", uncertainty.not_stated);
  json.later("u_temperature_scale", uncertainty.u_scale);
  json.later("u_camera_scale", uncertainty.u_camera_scale);
  json.later("u_distance", uncertainty.u_distance);
}

}  // namespace

Result<Json> uncertainty_record(const CurveUncertainty& uncertainty) {
  return json_of(uncertainty, uncertainty_fields);
}

Result<CurveUncertainty> uncertainty_from(const Json& record) {
  return from_json<CurveUncertainty>(record, uncertainty_fields);
}

void add_uncertainty(Json& curve, const CurveUncertainty& uncertainty) {
  Json record = printed_json(uncertainty, uncertainty_fields);
  for (std::size_t i = 0; i < curve["points"].size() && i < uncertainty.points.size(); ++i) {
    for (const char* key : {"s75_expanded95_mrad", "acuity_expanded95_per_mrad", "u_ln_acuity"})
      curve["points"][i][key] = record["points"][i][key];
  }
  curve["uncertainty"] = std::move(record);
}

}  // namespace todbench
