// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/serial_number.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace todbench {
namespace {

/// Known placeholders, in lower case, without blanks and punctuation.
constexpr std::array<std::string_view, 20> known{
    "default",  "defaultstring",   "none",         "na",   "null", "unknown", "serial", "serialnumber", "sn",
    "sn0001",   "tobefilledbyoem", "notspecified", "test", "0001", "000001",  "010000", "0x0001",       "xxx",
    "deadbeef", "abc123"};

constexpr std::string_view in_order = "0123456789abcdef0123456789";
constexpr std::string_view decimal = "1234567890123456789012345";

bool digits_only(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// 20YY0101, alone or followed by a counter of up to four digits with a value below 10.
bool first_of_january(std::string_view text) {
  if (text.size() < 8 || text.size() > 12 || !digits_only(text) || !text.starts_with("20")) return false;
  if (text.substr(4, 4) != "0101") return false;
  const std::string_view counter = text.substr(8);
  return counter.size() <= 1 || std::all_of(counter.begin(), counter.end() - 1, [](char c) { return c == '0'; });
}

}  // namespace

bool is_placeholder_serial(std::string_view serial) {
  std::string text;
  for (const unsigned char c : serial) {
    if (std::isalnum(c) != 0) text += static_cast<char>(std::tolower(c));
  }
  if (text.empty()) return true;
  const bool one_character = std::all_of(text.begin(), text.end(), [&](char c) { return c == text.front(); });
  if (one_character && (text.size() >= 3 || text.front() == '0')) return true;
  constexpr std::size_t a_row = 4;
  if (text.size() >= a_row && (in_order.starts_with(text) || decimal.starts_with(text))) return true;
  if (std::find(known.begin(), known.end(), text) != known.end()) return true;
  return first_of_january(text);
}

std::string placeholder_serial_warning(std::string_view serial) {
  if (serial.empty() || !is_placeholder_serial(serial)) return {};
  return "The serial number " + std::string(serial) +
         " is a placeholder that many cameras share, so it does not identify this camera. State 'unit' in the plan.";
}

}  // namespace todbench
