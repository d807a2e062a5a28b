// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and sentences as lines of a terminal, which would otherwise break long lines within words.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Returns the number of characters of a UTF-8 text without combining characters.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// Breaks a line at blanks into lines of at most `columns`. Continuation lines are indented to the text after the last
/// gap of at least two blanks in the first half of the columns, or without a gap like the line itself.
/// Longer words are not broken. A line that fits keeps its blanks.
[[nodiscard]] std::vector<std::string> broken_line(std::string_view line, std::size_t columns);

/// Returns a header, a rule and rows with aligned columns: numbers to the right, words to the left. Without `columns`,
/// or if the table fits, each row is one line. Otherwise the headers are broken over several lines, and then the cells
/// of the last column, if it contains words. If that is not enough, every row becomes a list of "header: cell", with an
/// empty line between rows.
[[nodiscard]] std::vector<std::string> table_lines(const std::vector<std::string>& header,
                                                   const std::vector<std::vector<std::string>>& rows,
                                                   std::optional<std::size_t> columns = std::nullopt);

}  // namespace todbench
