// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/uncertainty_record.h"

#include "bench/text/json_reader.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

Json applied_json(const AppliedRow& applied) {
  const BudgetRow& row = applied.row;
  Json commons = Json::array();
  for (const BudgetCommon common : row.common) commons.push_back(to_string(common));
  return {{"name", row.name},
          {"enters", to_string(applied.input)},
          {"stated_by", applied.from_run ? "run" : "plan"},
          {"value", row.value},
          {"unit", row.unit},
          {"distribution", to_string(row.distribution)},
          {"coverage_factor", row.coverage_factor},
          {"degrees_of_freedom", json_number(row.degrees_of_freedom)},
          {"sensitivity", json_number(row.sensitivity)},
          {"standard_uncertainty", json_number(applied.standard_uncertainty)},
          {"contribution", json_number(applied.contribution)},
          {"share_percent", json_number(applied.share_percent)},
          {"source", row.source},
          {"certificate", row.certificate},
          {"common", commons}};
}

AppliedRow applied_from(const JsonReader& item) {
  AppliedRow applied;
  BudgetRow& row = applied.row;
  row.name = item.at("name").text();
  applied.input = row.enters = item.at("enters").named(budget_inputs);
  applied.from_run = item.at("stated_by").text() == "run";
  row.value = item.at("value").number();
  row.unit = item.at("unit").text();
  row.distribution = item.at("distribution").named(budget_distributions);
  row.coverage_factor = item.at("coverage_factor").number();
  row.degrees_of_freedom = item.at("degrees_of_freedom").optional_number();
  row.sensitivity = item.at("sensitivity").optional_number();
  applied.standard_uncertainty = item.at("standard_uncertainty").number();
  applied.contribution = item.at("contribution").number();
  applied.share_percent = item.at("share_percent").number();
  row.source = item.at("source").text();
  row.certificate = item.at("certificate").text();
  for (const JsonReader& common : item.at("common").elements()) row.common.push_back(common.named(budget_commons));
  return applied;
}

Json point_json(const PointUncertainty& point) {
  const CombinedUncertainty found = point.combined.value_or(CombinedUncertainty{});
  const auto known = [&](double value) { return point.combined ? json_number(value) : Json(); };
  Json json{{"delta_t_k", json_number(point.set_delta_t_k)},
            {"contrast_slope", json_number(point.contrast_slope)},
            {"u_ln_acuity", known(found.u)},
            {"nu_eff", json_number(found.nu_eff)},
            {"k", known(found.k)},
            {"expanded_gum", known(found.expanded_gum)},
            {"expanded_monte_carlo", known(found.expanded_monte_carlo)},
            {"expanded", known(found.expanded)},
            {"u_stated", json_number(point.u_stated)},
            {"u_not_common_to_twin", json_number(point.u_not_twin)},
            {"u_not_common_to_series", json_number(point.u_not_series)},
            {"u_not_common_to_contrasts", json_number(point.u_not_contrasts)},
            {"s75_ci95_mrad", json_interval(point.statistical_mrad)},
            {"s75_expanded95_mrad", json_interval(point.expanded_mrad)},
            {"acuity_ci95_per_mrad", json_interval(acuity_interval(point.statistical_mrad))},
            {"acuity_expanded95_per_mrad", json_interval(acuity_interval(point.expanded_mrad))}};
  json["ratio"] = nullptr;
  if (point.ratio)
    json["ratio"] = {{"expanded95", json_interval(point.ratio->ci95)},
                     {"expanded90", json_interval(point.ratio->ci90)}};
  json["rows"] = Json::array();
  for (const AppliedRow& row : point.rows) json["rows"].push_back(applied_json(row));
  return json;
}

PointUncertainty point_from(const JsonReader& item) {
  PointUncertainty point{
      .set_delta_t_k = item.at("delta_t_k").number(), .contrast_slope = item.at("contrast_slope").number(), .rows = {}};
  for (const JsonReader& row : item.at("rows").elements()) point.rows.push_back(applied_from(row));
  if (const auto u = item.at("u_ln_acuity").optional_number()) {
    point.combined = CombinedUncertainty{.u = *u,
                                         .nu_eff = item.at("nu_eff").optional_number(),
                                         .k = item.at("k").number(),
                                         .expanded_gum = item.at("expanded_gum").number(),
                                         .expanded_monte_carlo = item.at("expanded_monte_carlo").number(),
                                         .expanded = item.at("expanded").number(),
                                         .shares = {}};
    for (const AppliedRow& row : point.rows)
      point.combined->shares.push_back({row.standard_uncertainty, row.contribution, row.share_percent});
  }
  point.u_stated = item.at("u_stated").number();
  point.u_not_twin = item.at("u_not_common_to_twin").number();
  point.u_not_series = item.at("u_not_common_to_series").number();
  point.u_not_contrasts = item.at("u_not_common_to_contrasts").number();
  point.statistical_mrad = item.at("s75_ci95_mrad").interval();
  point.expanded_mrad = item.at("s75_expanded95_mrad").interval();
  if (const JsonReader ratio = item.at("ratio"); !ratio.is_null())
    point.ratio = ExpandedRatio{ratio.at("expanded95").interval(), ratio.at("expanded90").interval()};
  return point;
}

}  // namespace

Json uncertainty_json(const CurveUncertainty& uncertainty) {
  Json points = Json::array();
  for (const PointUncertainty& point : uncertainty.points) points.push_back(point_json(point));
  return {{"points", points},
          {"not_stated", uncertainty.not_stated},
          {"u_temperature_scale", json_number(uncertainty.u_scale)},
          {"u_camera_scale", json_number(uncertainty.u_camera_scale)},
          {"u_distance", json_number(uncertainty.u_distance)}};
}

Result<CurveUncertainty> uncertainty_from(const Json& record) {
  const JsonReader reader(record);
  CurveUncertainty uncertainty;
  for (const JsonReader& point : reader.at("points").elements()) uncertainty.points.push_back(point_from(point));
  uncertainty.not_stated = reader.at("not_stated").texts();
  uncertainty.u_scale = reader.at_if_there("u_temperature_scale").optional_number().value_or(0);
  uncertainty.u_camera_scale = reader.at_if_there("u_camera_scale").optional_number().value_or(0);
  uncertainty.u_distance = reader.at_if_there("u_distance").optional_number().value_or(0);
  if (auto finished = reader.finish(); !finished) return tl::unexpected(finished.error());
  return uncertainty;
}

void add_uncertainty(Json& curve, const CurveUncertainty& uncertainty) {
  Json record = uncertainty_json(uncertainty);
  for (std::size_t i = 0; i < curve["points"].size() && i < uncertainty.points.size(); ++i) {
    for (const char* key : {"s75_expanded95_mrad", "acuity_expanded95_per_mrad", "u_ln_acuity"})
      curve["points"][i][key] = record["points"][i][key];
  }
  curve["uncertainty"] = std::move(record);
}

}  // namespace todbench
