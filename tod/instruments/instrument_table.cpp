// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/instruments/instrument_table.h"

#include <charconv>
#include <cmath>
#include <utility>

namespace todbench {
namespace {

constexpr std::string_view number_place = "{}";

std::string_view after_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  return text;
}

/// Removes the text of `words` from the front of `text`, ignoring blanks.
bool take_words(std::string_view& text, std::string_view words) {
  for (words = after_blanks(words); !words.empty(); words = after_blanks(words)) {
    text = after_blanks(text);
    if (text.empty() || text.front() != words.front()) return false;
    text.remove_prefix(1);
    words.remove_prefix(1);
  }
  return true;
}

std::optional<double> take_number(std::string_view& text) {
  text = after_blanks(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc{} || !std::isfinite(value)) return {};
  text.remove_prefix(static_cast<std::size_t>(parsed.ptr - text.data()));
  return value;
}

}  // namespace

std::vector<InstrumentUnit> difference_units() {
  return {{"K", 1, 0}, {"mK", 1e-3, 0}, {"degC", 1, 0}, {"degF", 5.0 / 9, 0}};
}

std::vector<InstrumentUnit> temperature_units() {
  return {{"K", 1, 0}, {"mK", 1e-3, 0}, {"degC", 1, 273.15}, {"degF", 5.0 / 9, 459.67 * 5 / 9}};
}

std::vector<InstrumentUnit> length_units() {
  return {{"mm", 1, 0}, {"um", 1e-3, 0}, {"m", 1e3, 0}, {"in", 25.4, 0}};
}

std::string_view to_string(InstrumentKind kind) {
  return kind == InstrumentKind::black_body ? "black_body" : "stage";
}

std::optional<std::vector<double>> numbers_in(std::string_view answer, std::string_view form) {
  std::vector<double> numbers;
  for (;;) {
    const auto place = form.find(number_place);
    if (!take_words(answer, form.substr(0, place))) return {};
    if (place == std::string_view::npos) break;
    const auto number = take_number(answer);
    if (!number) return {};
    numbers.push_back(*number);
    form.remove_prefix(place + number_place.size());
  }
  if (!after_blanks(answer).empty()) return {};
  return numbers;
}

std::size_t places_in(std::string_view form) {
  std::size_t count = 0;
  for (auto place = form.find(number_place); place != std::string_view::npos;
       place = form.find(number_place, place + number_place.size()))
    ++count;
  return count;
}

std::string command_of(std::string_view form, const std::vector<std::string>& words) {
  std::string text;
  for (const auto& word : words) {
    const auto place = form.find(number_place);
    text += std::string(form.substr(0, place)) + word;
    form.remove_prefix(place + number_place.size());
  }
  return text + std::string(form);
}

std::string comma_form(std::size_t count) {
  std::string form;
  for (std::size_t i = 0; i < count; ++i) form += i == 0 ? "{}" : ",{}";
  return form;
}

}  // namespace todbench
