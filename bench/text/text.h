// SPDX-License-Identifier: GPL-3.0-or-later
// Text for files: exact number round trip, nearest names, whole files.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "acquisition/base/safe_text.h"

namespace todbench {

/// Returns the shortest decimal text that reads back as exactly `value` (at most 17 significant digits), with a dot in
/// every locale. Precondition: finite.
[[nodiscard]] std::string number_text(double value);
/// Parses a finite number that is the whole of `text`, in any locale; empty otherwise (blanks, trailing letters, nan,
/// inf, overflow).
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Returns the name in `known` with the smallest edit distance to `name` (a swap of neighbours counts one), if the
/// difference can be a typing error: a distance of at most a third of the length of `name`, or 1. The first of several
/// nearest names is used. Otherwise returns the first name whose first or last word is `name`; empty if there is none.
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);
/// Returns ", did you mean 'X'?" or an empty text.
[[nodiscard]] std::string nearest_name_hint(std::string_view name, std::span<const std::string> known);
/// Returns the words, each in single quotes, separated by commas.
[[nodiscard]] std::string quoted_list(std::span<const std::string> words);
/// Returns the permitted words for a message: "one of 'a', 'b'"; "'a'" for a single one.
[[nodiscard]] std::string one_of(std::span<const std::string> words);

/// Reads a whole configuration or input file. Errors: `invalid_input` (unreadable, or larger than 512 MiB).
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& file);

/// Splits one RFC 4180 record without its line end. Errors: `invalid_input` (misplaced quote).
[[nodiscard]] Result<std::vector<std::string>> split_csv(std::string_view line);
/// Returns a field in the format of RFC 4180: one_line(), quoted if it contains a comma, a quote or blanks at its ends.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace todbench
