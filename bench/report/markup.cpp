// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/markup.h"

namespace todbench {
namespace {

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
