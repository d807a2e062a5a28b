// SPDX-License-Identifier: GPL-3.0-or-later
// Spread over the open parameters of an observer with an eye (hvs/observer/open_parameters.h) in JSON and in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bench/text/json.h"

namespace todbench {

class JsonFields;

/// Adds the spread as [low, high]; adds no key if there is no spread.
void add_spread(Json& json, const char* key, const std::optional<std::pair<double, double>>& spread);
/// Reads or writes the spread under `key`. The key is omitted if there is no spread.
void spread_if_any(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread);
/// Reads or writes the spread under `key`, as an empty list if there is no spread.
void spread_or_empty_list(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread);
/// Returns "351 to 402 m over the open parameters of the observer (no confidence interval)".
[[nodiscard]] std::string spread_in_words(const std::pair<double, double>& spread, std::string_view unit);

}  // namespace todbench
