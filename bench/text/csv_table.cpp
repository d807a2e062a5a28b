// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/csv_table.h"

#include <algorithm>

#include "bench/text/text.h"

namespace todbench {

namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

}  // namespace

std::optional<std::size_t> CsvTable::column(std::string_view of) const {
  const auto found = std::ranges::find(header, of);
  if (found == header.end()) return std::nullopt;
  return static_cast<std::size_t>(found - header.begin());
}

tl::unexpected<Error> CsvTable::wrong(int line, const std::string& sentence) const {
  return fail(ErrorCode::invalid_input, name + ":" + std::to_string(line) + ": " + sentence);
}

Result<CsvTable> parse_csv(std::string_view text, std::string_view name) {
  CsvTable table;
  table.name = name;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte order mark of spreadsheet programs
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view content = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (content.ends_with('\r')) content.remove_suffix(1);
    content = without_blanks(content);
    if (content.empty()) continue;
    Result<std::vector<std::string>> fields = split_csv(content);
    if (!fields) return table.wrong(line, fields.error().message);
    for (std::string& field : *fields) {
      if (content.find('"') == std::string_view::npos) field = without_blanks(field);
    }
    if (table.header.empty()) {
      table.header = *std::move(fields);
      continue;
    }
    if (fields->size() != table.header.size()) {
      return table.wrong(line, "expected " + std::to_string(table.header.size()) + " fields as in the header, found " +
                                   std::to_string(fields->size()));
    }
    table.rows.push_back({line, *std::move(fields)});
  }
  if (table.header.empty()) return table.wrong(1, "the file is empty, expected a header with the names of the columns");
  return table;
}

}  // namespace todbench
