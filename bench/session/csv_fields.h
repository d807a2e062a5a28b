// SPDX-License-Identifier: GPL-3.0-or-later
// Parsing of the session's CSV files: header check and typed fields.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "bench/text/csv_table.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Succeeds if the header has exactly these columns in this order. Errors: `invalid_input` "NAME:1: ..." with the first
/// wrong column.
[[nodiscard]] Result<void> check_columns(const CsvTable& table, std::span<const std::string_view> columns);

/// Returns "presentation,plate,..." with a line end.
[[nodiscard]] std::string header_line(std::span<const std::string_view> columns);

/// Parses a whole number; empty if the text is anything else.
template <typename Whole>
[[nodiscard]] std::optional<Whole> parse_whole(std::string_view text) {
  Whole value{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Reads the fields of a row in order and keeps the first error. Keeps references to both arguments. `columns`: names
/// of the columns.
class FieldReader {
 public:
  FieldReader(std::span<const std::string> fields, std::span<const std::string_view> columns)
      : fields_(fields), columns_(columns) {}

  [[nodiscard]] std::string text() { return fields_[position_++]; }
  [[nodiscard]] double number();
  /// Returns a number; empty for an empty field.
  [[nodiscard]] std::optional<double> optional_number();
  /// Returns a probability; empty for an empty field.
  [[nodiscard]] std::optional<double> optional_probability();
  template <typename Whole>
  [[nodiscard]] Whole whole() {
    return taken(parse_whole<Whole>(fields_[position_]), "a whole number");
  }
  /// Returns a whole number of 0 or more.
  [[nodiscard]] int count() {
    const auto value = parse_whole<int>(fields_[position_]);
    return taken(value && *value >= 0 ? value : std::nullopt, "a whole number of 0 or more");
  }
  /// Returns a whole number; empty for an empty field.
  template <typename Whole>
  [[nodiscard]] std::optional<Whole> optional_whole() {
    if (skip_empty()) return std::nullopt;
    return whole<Whole>();
  }
  [[nodiscard]] Apex apex() { return taken(apex_from(fields_[position_]), "up, right, down or left"); }
  [[nodiscard]] Mounting mounting() { return taken(mounting_from(fields_[position_]), "a mounting"); }
  /// Returns the first error; empty if there was none.
  [[nodiscard]] const std::optional<std::string>& wrong() const { return wrong_; }

 private:
  [[nodiscard]] bool skip_empty();
  void note(std::string_view expected);
  template <typename T>
  T taken(const std::optional<T>& value, std::string_view expected) {
    if (!value) note(expected);
    ++position_;
    return value.value_or(T{});
  }

  std::span<const std::string> fields_;
  std::span<const std::string_view> columns_;
  std::size_t position_ = 0;
  std::optional<std::string> wrong_;
};

}  // namespace todbench
