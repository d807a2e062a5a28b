// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/cost_record.h"

#include "bench/text/json_reader.h"

namespace todbench {

Json cost_json(const CostFrontier& frontier) {
  Json thresholds = Json::array();
  for (const ThresholdEstimate& point : frontier.reference) {
    thresholds.push_back({{"delta_t_k", point.delta_t_k},
                          {"s75_pitch", json_number(point.s75_pitch)},
                          {"standard_error_pitch", json_number(point.standard_error_pitch)}});
  }
  Json points = Json::array();
  for (const CostPoint& point : frontier.points) {
    points.push_back({{"knob", point.knob},
                      {"setting", point.setting},
                      {"wall_s", json_number(point.wall_s)},
                      {"error_percent", json_number(point.error_percent)},
                      {"standard_error_percent", json_number(point.standard_error_percent)},
                      {"paired", point.paired},
                      {"chosen", point.chosen},
                      {"best", point.best},
                      {"not_measured", point.not_measured.empty() ? Json() : Json(point.not_measured)}});
  }
  return {{"reference",
           {{"wall_s", json_number(frontier.reference_s)},
            {"standard_error_percent", json_number(frontier.reference_standard_error_percent)},
            {"draws", frontier.reference_draws},
            {"paired_draws", frontier.paired_draws},
            {"points", thresholds}}},
          {"points", points},
          {"budget_s", frontier.budget_s},
          {"spent_s", json_number(frontier.spent_s)},
          {"notes", frontier.notes}};
}

Result<CostFrontier> cost_from(const Json& record) {
  const JsonReader all(record);
  const JsonReader reference = all.at("reference");
  CostFrontier out;
  out.reference_s = reference.at("wall_s").number();
  out.reference_standard_error_percent = reference.at("standard_error_percent").number();
  out.reference_draws = static_cast<int>(reference.at("draws").whole());
  out.paired_draws = static_cast<int>(reference.at("paired_draws").whole());
  for (const JsonReader& point : reference.at("points").elements()) {
    out.reference.push_back({.delta_t_k = point.at("delta_t_k").number(),
                             .s75_pitch = point.at("s75_pitch").number(),
                             .standard_error_pitch = point.at("standard_error_pitch").optional_number()});
  }
  for (const JsonReader& point : all.at("points").elements()) {
    const JsonReader reason = point.at("not_measured");
    out.points.push_back({.knob = point.at("knob").text(),
                          .setting = point.at("setting").text(),
                          .paired = point.at("paired").flag(),
                          .wall_s = point.at("wall_s").optional_number(),
                          .error_percent = point.at("error_percent").optional_number(),
                          .standard_error_percent = point.at("standard_error_percent").optional_number(),
                          .not_measured = reason.is_null() ? std::string() : reason.text(),
                          .chosen = point.at("chosen").flag(),
                          .best = point.at("best").flag()});
  }
  out.budget_s = all.at("budget_s").number();
  out.spent_s = all.at("spent_s").number();
  out.notes = all.at("notes").texts();
  if (auto read = all.finish(); !read) return tl::unexpected(read.error());
  return out;
}

}  // namespace todbench
