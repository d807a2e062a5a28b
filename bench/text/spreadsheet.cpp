// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/spreadsheet.h"

#include "bench/text/text.h"

namespace todbench {

std::string spreadsheet_field(std::string_view text) {
  constexpr std::string_view begins_a_formula = "=+-@\t\r\n";
  const std::size_t first = text.find_first_not_of(' ');
  const bool formula = first != std::string_view::npos &&
                       begins_a_formula.find(text[first]) != std::string_view::npos && !parse_number(text);
  return csv_field(formula ? "'" + std::string(text) : std::string(text));
}

}  // namespace todbench
