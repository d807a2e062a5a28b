// JSON as the bench writes it. A value that does not exist is null; NaN and infinity are never written.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Keys in the order in which they are added.
using Json = nlohmann::ordered_json;

/// The number, or null when it is missing or not finite.
[[nodiscard]] Json json_number(double value);
[[nodiscard]] Json json_number(const std::optional<double>& value);
/// [low, high], each side null where it is open.
[[nodiscard]] Json json_interval(const Interval& interval);
/// One line of text; invalid UTF-8 is replaced, and what steers a terminal (valid_text()) stands there as \u escapes.
/// Nothing throws.
[[nodiscard]] std::string to_line(const Json& json);
/// The same over several lines, for files.
[[nodiscard]] std::string to_page(const Json& json);

}  // namespace todbench
