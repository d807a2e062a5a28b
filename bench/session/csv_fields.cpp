// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/csv_fields.h"

#include <algorithm>

#include "bench/text/text.h"

namespace todbench {

Result<void> check_columns(const CsvTable& table, std::span<const std::string_view> columns) {
  for (std::size_t i = 0; i < std::max(columns.size(), table.header.size()); ++i) {
    const std::string found = i < table.header.size() ? "'" + one_line(table.header[i]) + "'" : "no column";
    const std::string expected = i < columns.size() ? std::string(columns[i]) : "no column";
    if (found != "'" + expected + "'")
      return table.wrong(1, "column " + std::to_string(i + 1) + ": expected " + expected + ", found " + found);
  }
  return {};
}

std::string header_line(std::span<const std::string_view> columns) {
  std::string header;
  for (const std::string_view column : columns) (header += header.empty() ? "" : ",") += column;
  return header + "\n";
}

double FieldReader::number() {
  return taken(parse_number(fields_[position_]), "a finite number");
}

std::optional<double> FieldReader::optional_number() {
  if (skip_empty()) return std::nullopt;
  return number();
}

std::optional<double> FieldReader::optional_probability() {
  if (skip_empty()) return std::nullopt;
  const auto value = parse_number(fields_[position_]);
  return taken(value && *value >= 0 && *value <= 1 ? value : std::nullopt, "a number from 0 to 1");
}

bool FieldReader::skip_empty() {
  if (!fields_[position_].empty()) return false;
  ++position_;
  return true;
}

void FieldReader::note(std::string_view expected) {
  if (wrong_) return;
  wrong_ = "column " + std::string(columns_[position_]) + ": expected " + std::string(expected) + ", found '" +
           one_line(fields_[position_]) + "'";
}

}  // namespace todbench
