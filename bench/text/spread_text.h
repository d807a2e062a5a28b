// SPDX-License-Identifier: GPL-3.0-or-later
// A spread over the open parameters of an observer with an eye (hvs/observer/open_parameters.h) in JSON and in words.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "bench/text/json.h"

namespace todbench {

class JsonFields;

/// Adds [low, high]; no key without a spread.
void add_spread(Json& json, const char* key, const std::optional<std::pair<double, double>>& spread);
/// The same key of a record, for both directions; omitted without a spread.
void spread_if_any(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread);
/// The same with an empty list without a spread.
void spread_or_empty_list(JsonFields& json, const std::string& key, std::optional<std::pair<double, double>>& spread);
/// Returns "351 to 402 m over the open parameters of the observer (no confidence interval)".
[[nodiscard]] std::string spread_in_words(const std::pair<double, double>& spread, std::string_view unit);

}  // namespace todbench
