// Text in and out of files: numbers that survive the round trip, names that are nearly right, whole files.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "acquisition/core/safe_text.h"

namespace todbench {

/// The shortest decimal text that reads back as exactly `value` (at most 17 significant digits), with a dot in every
/// locale. Precondition: finite.
[[nodiscard]] std::string number_text(double value);
/// The finite number that is the whole of `text`, in any locale; nothing otherwise (blanks, trailing letters, nan, inf,
/// overflow).
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// The name in `known` with the smallest edit distance to `name` (swapped neighbours count one), if it is close enough
/// to be a slip of the pen (at most a third of its letters, at least one; ties: the first).
[[nodiscard]] std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);
/// ", did you mean 'X'?" or nothing.
[[nodiscard]] std::string nearest_name_hint(std::string_view name, std::span<const std::string> known);
/// The words, each in single quotes, with commas.
[[nodiscard]] std::string quoted_list(std::span<const std::string> words);

/// A configuration or input file, whole. `invalid_input` with one sentence when it cannot be read or is larger than
/// 512 MiB.
[[nodiscard]] Result<std::string> read_text_file(const std::filesystem::path& file);

/// Splits one RFC 4180 record without its line end; `invalid_input` for a quote in the wrong place.
[[nodiscard]] Result<std::vector<std::string>> split_csv(std::string_view line);
/// A field as RFC 4180 wants it: one_line(), quoted where it contains a comma, a quote or blanks at its ends.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace todbench
