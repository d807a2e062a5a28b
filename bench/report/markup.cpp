#include "bench/report/markup.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace todbench {
namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";

bool continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// Length in bytes of the UTF-8 character at `position`, 0 where the bytes are none (RFC 3629: shortest form, no
/// surrogates, <= U+10FFFF) or where XML 1.0 forbids the character.
std::size_t character_length(std::string_view text, std::size_t position) {
  const auto lead = static_cast<unsigned char>(text[position]);
  if (lead < 0x80U) return lead >= 0x20U && lead != 0x7FU ? 1 : (lead == '\t' || lead == '\n' || lead == '\r' ? 1 : 0);
  const std::size_t length = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  if (lead < 0xC2U || lead > 0xF4U || position + length > text.size()) return 0;
  std::uint32_t code = lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (!continuation(text[position + i])) return 0;
    code = (code << 6U) | (static_cast<unsigned char>(text[position + i]) & 0x3FU);
  }
  constexpr std::array<std::uint32_t, 5> smallest{0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800U && code <= 0xDFFFU;
  const bool c1_control = code < 0xA0U;
  const bool noncharacter = code == 0xFFFEU || code == 0xFFFFU;
  return code < smallest[length] || code > 0x10FFFFU || surrogate || c1_control || noncharacter ? 0 : length;
}

std::string_view entity(char character) {
  switch (character) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

}  // namespace

Markup& Markup::operator+=(const Markup& more) {
  text += more.text;
  return *this;
}

Markup literal(std::string_view markup) {
  return Markup{std::string(markup)};
}

std::string valid_text(std::string_view plain) {
  std::string text;
  for (std::size_t i = 0; i < plain.size();) {
    const std::size_t length = character_length(plain, i);
    text += length == 0 ? replacement : plain.substr(i, length);
    i += length == 0 ? 1 : length;
  }
  return text;
}

Markup escaped(std::string_view plain) {
  Markup result;
  for (const char character : valid_text(plain)) {
    const std::string_view known = entity(character);
    if (known.empty()) {
      result.text += character;
    } else {
      result.text += known;
    }
  }
  return result;
}

Markup element(std::string_view tag, const Markup& content, std::string_view attributes) {
  Markup result;
  std::string& text = result.text;
  text.reserve(content.text.size() + attributes.size() + 2 * tag.size() + 6);
  text.append("<").append(tag);
  if (!attributes.empty()) text.append(" ").append(attributes);
  text.append(">").append(content.text).append("</").append(tag).append(">");
  return result;
}

}  // namespace todbench
