// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/display_record.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "bench/text/json_fields.h"
#include "bench/text/spread_text.h"

namespace todbench {
namespace {

void sort_costs(std::vector<FactorCost>& costs) {
  std::ranges::stable_sort(costs, std::ranges::greater(), &FactorCost::percent);
}

void limits_fields(JsonFields& json, AcuityLimits& limits) {
  std::map<std::string, double> costs;
  for (const FactorCost& cost : limits.costs) costs[std::string(to_string(cost.factor))] = cost.percent;
  json.value("delta_t_k", limits.delta_t_k);
  json.value("s75_mrad", limits.s75_mrad);
  json.derived("limited_by", limits.costs.empty() ? Json(nullptr) : Json(to_string(limits.costs.front().factor)));
  json.value("cost_percent", costs);
  limits.costs.clear();
  for (const LimitingFactor factor : all_limiting_factors) {
    if (const auto found = costs.find(std::string(to_string(factor))); found != costs.end())
      limits.costs.push_back({factor, found->second});
  }
  sort_costs(limits.costs);
}

void point_fields(JsonFields& json, DisplayedPoint& point) {
  json.value("delta_t_k", point.delta_t_k);
  json.value("s75_mrad", point.s75_mrad);
  spread_or_empty_list(json, "s75_spread_mrad", point.spread_mrad);
}

}  // namespace

std::string_view to_string(LimitingFactor factor) {
  switch (factor) {
    case LimitingFactor::sampling:
      return "sampling";
    case LimitingFactor::sensor_noise:
      return "sensor_noise";
    case LimitingFactor::display:
      return "display";
    case LimitingFactor::eye:
      return "eye";
    case LimitingFactor::light:
      return "light";
    case LimitingFactor::observer:
      return "observer";
  }
  return "";
}

std::string in_words(const AcuityLimits& limits) {
  const auto name = [](LimitingFactor factor) -> std::string_view {
    return factor == LimitingFactor::sensor_noise ? "sensor noise" : to_string(factor);
  };
  std::string text = fmt::format("at {:g} K", limits.delta_t_k);
  if (limits.costs.empty()) return text + " nothing that can be left out limits the acuity";
  text += fmt::format(" the {} limits the acuity most; S75 is larger than without it by: ",
                      name(limits.costs.front().factor));
  for (std::size_t i = 0; i < limits.costs.size(); ++i) {
    // Adding 0 turns a rounded -0 into 0.
    text += fmt::format("{}{} {:.0f} %", i == 0 ? "" : ", ", name(limits.costs[i].factor),
                        std::round(limits.costs[i].percent) + 0.0);
  }
  return text;
}

Json acuity_limits_json(const std::vector<AcuityLimits>& limits) {
  Json json = Json::array();
  for (const AcuityLimits& at : limits) {
    Json costs = Json::object();
    for (const FactorCost& cost : at.costs) costs[std::string(to_string(cost.factor))] = json_number(cost.percent);
    json.push_back({{"delta_t_k", at.delta_t_k},
                    {"s75_mrad", json_number(at.s75_mrad)},
                    {"limited_by", at.costs.empty() ? Json(nullptr) : Json(to_string(at.costs.front().factor))},
                    {"cost_percent", std::move(costs)}});
  }
  return json;
}

void display_fields(JsonFields& json, DisplayRecord& record) {
  json.value("observer", record.observer);
  json.value("points", record.points, point_fields);
  json.value("acuity_limits", record.limits, limits_fields);
}

}  // namespace todbench
