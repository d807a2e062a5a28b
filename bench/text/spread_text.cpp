// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/spread_text.h"

#include <fmt/format.h>
#include <vector>

#include "bench/text/json_fields.h"

namespace todbench {

void add_spread(Json& json, const char* key, const std::optional<std::pair<double, double>>& spread) {
  if (spread) json[key] = {json_number(spread->first), json_number(spread->second)};
}

namespace {

std::vector<double> list_of_ends(const std::optional<std::pair<double, double>>& spread) {
  return spread ? std::vector{spread->first, spread->second} : std::vector<double>();
}

std::optional<std::pair<double, double>> spread_from(const std::vector<double>& ends) {
  return ends.size() == 2 ? std::optional(std::pair(ends[0], ends[1])) : std::nullopt;
}

}  // namespace

void spread_if_any(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread) {
  std::optional<std::vector<double>> ends;
  if (spread) ends = list_of_ends(spread);
  json.if_any(key, ends);
  if (ends) spread = spread_from(*ends);
}

void spread_or_empty_list(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread) {
  std::vector<double> ends = list_of_ends(spread);
  json.value(key, ends);
  spread = spread_from(ends);
}

std::string spread_in_words(const std::pair<double, double>& spread, std::string_view unit) {
  return fmt::format("{:.3g} to {:.3g} {} over the open parameters of the observer (no confidence interval)",
                     spread.first, spread.second, unit);
}

}  // namespace todbench
