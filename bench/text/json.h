// SPDX-License-Identifier: GPL-3.0-or-later
// JSON output of the bench. Absent values are null; NaN and infinity are never written.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// JSON value that keeps keys in the order of insertion.
using Json = nlohmann::ordered_json;

/// Return the number; null if it is absent or not finite.
[[nodiscard]] Json json_number(double value);
[[nodiscard]] Json json_number(const std::optional<double>& value);
/// Returns the list of the numbers, with null in place of numbers that are not finite.
[[nodiscard]] Json json_numbers(std::span<const double> values);
/// Returns [low, high]; an open limit is null.
[[nodiscard]] Json json_interval(const Interval& interval);
/// Returns one line of text. Invalid UTF-8 is replaced, and terminal control characters (valid_text()) become \u
/// escapes. Never throws.
[[nodiscard]] std::string to_line(const Json& json);
/// Returns the text over several lines, for files.
[[nodiscard]] std::string to_page(const Json& json);

}  // namespace todbench
