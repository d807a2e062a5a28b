// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/safe_text.h"

#include <array>
#include <cstdint>
#include <cstdio>

namespace todbench {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";
constexpr std::string_view ellipsis = "\xE2\x80\xA6";

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  ///< 0: no character begins here (RFC 3629: shortest form, no surrogates, <= U+10FFFF)
};

Character character_at(std::string_view text, std::size_t position) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[position + i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80U) return {lead, 1};
  const std::size_t bytes = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  if (lead < 0xC2U || lead > 0xF4U || position + bytes > text.size()) return {};
  std::uint32_t code = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  return code < smallest[bytes] || code > 0x10FFFFU || surrogate ? Character{} : Character{code, bytes};
}

bool is_blank_control(std::uint32_t code) {
  return code == '\t' || code == '\n' || code == '\r';
}

bool steers(std::uint32_t code) {
  if (code < 0x20U) return !is_blank_control(code);
  const auto within = [code](std::uint32_t from, std::uint32_t to) { return code >= from && code <= to; };
  return within(0x7FU, 0x9FU) || code == 0x61CU || within(0x200EU, 0x200FU) || within(0x2028U, 0x202EU) ||
         within(0x2066U, 0x2069U) || code == 0xFEFFU || within(0xFFFEU, 0xFFFFU);
}

}  // namespace

std::string valid_text(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const Character found = character_at(text, i);
    const bool shown = found.bytes > 0 && !steers(found.code);
    out += shown ? text.substr(i, found.bytes) : replacement;
    i += found.bytes > 0 ? found.bytes : 1;
  }
  return out;
}

std::string one_line(std::string_view text, std::size_t longest) {
  std::string out;
  std::size_t characters = 0;
  for (std::size_t i = 0; i < text.size(); ++characters) {
    if (characters == longest) return out += ellipsis;
    const Character found = character_at(text, i);
    const bool control = found.bytes == 1 && (found.code < 0x20U || found.code == 0x7FU);
    const bool shown = found.bytes > 0 && !steers(found.code);
    out += control ? " " : shown ? text.substr(i, found.bytes) : replacement;
    i += found.bytes > 0 ? found.bytes : 1;
  }
  return out;
}

std::string escaped_json(std::string_view json) {
  std::string out;
  out.reserve(json.size());
  for (std::size_t i = 0; i < json.size();) {
    const Character found = character_at(json, i);
    if (found.bytes > 0 && steers(found.code)) {
      std::array<char, 12> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(found.code));
      out += escape.data();
    } else {
      out += found.bytes > 0 ? json.substr(i, found.bytes) : replacement;
    }
    i += found.bytes > 0 ? found.bytes : 1;
  }
  return out;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace todbench
