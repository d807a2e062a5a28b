// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/json.h"

#include <cmath>

#include "acquisition/base/safe_text.h"

namespace todbench {

Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json json_number(const std::optional<double>& value) {
  return value ? json_number(*value) : Json(nullptr);
}

Json json_numbers(std::span<const double> values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(json_number(value));
  return list;
}

Json json_interval(const Interval& interval) {
  return Json::array({json_number(interval.low), json_number(interval.high)});
}

std::string to_line(const Json& json) {
  return escaped_json(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string to_page(const Json& json) {
  return escaped_json(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

}  // namespace todbench
