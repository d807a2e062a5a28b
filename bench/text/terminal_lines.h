// Tables and sentences as lines of a terminal. A terminal breaks a line that is too long in the middle of a word.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Characters on screen of a UTF-8 text without combining characters.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// A line broken at its blanks into lines of at most so many columns. Further ones begin below what stands behind the
/// last gap of two blanks or more in the first half of the columns, or behind the indent. A word that is longer stays
/// whole. Blanks inside a line that fits stay as they are.
[[nodiscard]] std::vector<std::string> broken_line(std::string_view line, std::size_t columns);

/// A header, a rule and rows, the columns aligned: numbers to the right, words to the left. Without `columns`, or where
/// the table fits, a line each. Otherwise headers go over several lines, then the cells of a last column of words; and
/// where that is not enough every row is a list of "header: cell", with an empty line between two.
[[nodiscard]] std::vector<std::string> table_lines(const std::vector<std::string>& header,
                                                   const std::vector<std::vector<std::string>>& rows,
                                                   std::optional<std::size_t> columns = std::nullopt);

}  // namespace todbench
