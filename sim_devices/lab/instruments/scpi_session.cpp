// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/instruments/scpi_session.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "tod/instruments/scpi_client.h"

namespace todbench {
namespace {

constexpr std::size_t longest_error_queue = 16;

char upper(char c) {
  return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
}
bool is_space(char c) {
  return c == ' ' || c == '\t';
}

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return upper(x) == upper(y); });
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

// Parts between separators outside quotes. The flag says whether every quote was closed.
std::pair<std::vector<std::string_view>, bool> split_outside_quotes(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  char quote = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quote != 0) {
      if (c == quote) quote = 0;  // a doubled quote closes and opens again, with the same effect
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == separator) {
      parts.push_back(text.substr(begin, i - begin));
      begin = i + 1;
    }
  }
  parts.push_back(text.substr(begin));
  return {std::move(parts), quote == 0};
}

std::string unquoted(std::string_view text) {
  text = trimmed(text);
  if (text.size() < 2 || (text.front() != '"' && text.front() != '\'') || text.back() != text.front())
    return std::string(text);
  const char quote = text.front();
  text = text.substr(1, text.size() - 2);
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    plain += text[i];
    if (text[i] == quote) ++i;  // the second of a doubled quote
  }
  return plain;
}

// First node of a command's header: its mnemonic without brackets, whether it is optional, and the rest.
struct Node {
  std::string_view mnemonic, rest;
  bool optional = false;
};
Node first_node(std::string_view header) {
  Node node;
  node.optional = header.starts_with('[');
  if (node.optional) {
    const auto end = header.find(']');
    node.rest = header.substr(end + 1);
    node.mnemonic = header.substr(1, end - 1);
    if (node.mnemonic.ends_with(':')) node.mnemonic.remove_suffix(1);
    if (node.mnemonic.starts_with(':')) node.mnemonic.remove_prefix(1);
  } else {
    const auto end = header.find_first_of(":[");
    node.mnemonic = header.substr(0, end);
    node.rest = end == std::string_view::npos ? std::string_view{} : header.substr(end);
  }
  if (node.rest.starts_with(':')) node.rest.remove_prefix(1);
  return node;
}

// Compares `header` as in a manual with `text` as received, both without the '?' of a query. The recursion is as deep
// as the header has nodes.
bool matches(std::string_view header, std::string_view text) {
  if (header.empty()) return text.empty();
  const Node node = first_node(header);
  if (node.optional && matches(node.rest, text)) return true;
  const auto colon = text.find(':');
  if (text.empty() || !scpi_keyword(text.substr(0, colon), node.mnemonic)) return false;
  if (colon == std::string_view::npos) return matches(node.rest, {});
  return colon + 1 < text.size() && matches(node.rest, text.substr(colon + 1));
}

bool header_is(std::string_view pattern, std::string_view text) {
  if (pattern.ends_with('?') != text.ends_with('?')) return false;
  if (pattern.ends_with('?')) {
    pattern.remove_suffix(1);
    text.remove_suffix(1);
  }
  return matches(pattern, text);
}

}  // namespace

bool scpi_keyword(std::string_view text, std::string_view mnemonic) {
  const auto short_end = std::find_if(mnemonic.begin(), mnemonic.end(),
                                      [](char c) { return std::islower(static_cast<unsigned char>(c)) != 0; });
  const auto short_form = mnemonic.substr(0, static_cast<std::size_t>(short_end - mnemonic.begin()));
  return equal_ignoring_case(text, short_form) || equal_ignoring_case(text, mnemonic);
}

tl::expected<double, ScpiError> scpi_number(std::string_view text, double min, double max, std::string_view unit) {
  text = trimmed(text);
  if (scpi_keyword(text, "MINimum")) return min;
  if (scpi_keyword(text, "MAXimum")) return max;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  // from_chars also accepts "inf" and "nan", which are not SCPI numbers here.
  if (parsed.ec == std::errc::result_out_of_range) return tl::unexpected(ScpiError{-222, "Data out of range"});
  if (parsed.ec != std::errc{} || !std::isfinite(value)) return tl::unexpected(ScpiError{-104, "Data type error"});
  const auto suffix = trimmed(text.substr(static_cast<std::size_t>(parsed.ptr - text.data())));
  if (!suffix.empty() && !equal_ignoring_case(suffix, unit)) return tl::unexpected(ScpiError{-131, "Invalid suffix"});
  if (value < min || value > max) return tl::unexpected(ScpiError{-222, "Data out of range"});
  return value;
}

tl::expected<void, ScpiError> scpi_count(std::span<const std::string> parameters, std::size_t count) {
  if (parameters.size() < count) return tl::unexpected(ScpiError{-109, "Missing parameter"});
  if (parameters.size() > count) return tl::unexpected(ScpiError{-108, "Parameter not allowed"});
  return {};
}

std::string scpi_decimal(double value, int decimals) {
  // SCPI's code for "not a number" (SCPI-99 volume 1, 7.2.1.5).
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "9.91E37";
}

ScpiLanguage::ScpiLanguage(std::string identity, std::vector<ScpiCommand> commands)
    : identity_(std::move(identity)), commands_(std::move(commands)) {}

const ScpiCommand* ScpiLanguage::find(std::string_view header) const {
  const auto found = std::find_if(commands_.begin(), commands_.end(),
                                  [&](const ScpiCommand& command) { return header_is(command.header, header); });
  return found == commands_.end() ? nullptr : &*found;
}

void ScpiSession::report(ScpiError error) {
  if (errors_.size() < longest_error_queue)
    errors_.push_back(std::move(error));
  else
    errors_.back() = {-350, "Queue overflow"};
}

std::string ScpiSession::next_error() {
  if (errors_.empty()) return "0,\"No error\"";
  const ScpiError error = errors_.front();
  errors_.pop_front();
  return std::to_string(error.code) + "," + scpi_quoted(error.message);
}

ScpiAnswer ScpiSession::run(const std::string& header, std::span<const std::string> parameters) {
  const bool no_parameters = parameters.empty();
  const auto is = [&](std::string_view pattern) { return header_is(pattern, header); };
  if (is("*IDN?") || is("*CLS") || is("*OPC?") || is("SYSTem:ERRor[:NEXT]?") || is("SYSTem:VERSion?")) {
    if (!no_parameters) return tl::unexpected(ScpiError{-108, "Parameter not allowed"});
    if (is("*IDN?")) return language_->identity();
    if (is("*OPC?")) return "1";  // commands run one after the other; the status register reports settling
    if (is("SYSTem:VERSion?")) return "1999.0";
    if (is("SYSTem:ERRor[:NEXT]?")) return next_error();
    errors_.clear();
    return "";
  }
  const ScpiCommand* command = language_->find(header);
  if (command == nullptr) return tl::unexpected(ScpiError{-113, "Undefined header"});
  return command->run(parameters);
}

std::string ScpiSession::execute(std::string_view message) {
  const auto is_control = [](unsigned char c) { return (c < 0x20 && c != '\t') || c > 0x7e; };
  if (std::any_of(message.begin(), message.end(), is_control)) {
    report({-101, "Invalid character"});
    return {};
  }
  const auto [units, closed] = split_outside_quotes(message, ';');
  if (!closed) {
    report({-151, "Invalid string data"});
    return {};
  }
  std::string response, path;
  for (const std::string_view raw : units) {
    const auto unit = trimmed(raw);
    if (unit.empty()) continue;
    const auto header_end = std::min(unit.find_first_of(" \t"), unit.size());
    std::string header(unit.substr(0, header_end));
    if (header.starts_with(':'))
      header.erase(0, 1);
    else if (!header.starts_with('*'))
      header.insert(0, path);
    if (!header.starts_with('*')) path = header.substr(0, header.rfind(':') + 1);

    std::vector<std::string> parameters;
    const auto data = trimmed(unit.substr(header_end));
    if (!data.empty())
      for (const auto part : split_outside_quotes(data, ',').first) parameters.push_back(unquoted(part));

    ScpiAnswer answer = run(header, parameters);
    if (!answer) {
      const int code = answer.error().code;
      report(std::move(answer.error()));
      if (code <= -100 && code > -200) break;
    } else if (!answer->empty()) {
      response += (response.empty() ? "" : ";") + *answer;
    }
  }
  return response;
}

}  // namespace todbench
