// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/report/document.h"

namespace todbench {

RichText& RichText::operator+=(const RichText& more) {
  phrases.insert(phrases.end(), more.phrases.begin(), more.phrases.end());
  return *this;
}

RichText plain(std::string_view text) {
  return {{{std::string(text), Meaning::plain}}};
}

RichText strong(std::string_view text) {
  return {{{std::string(text), Meaning::strong}}};
}

RichText unbroken(std::string_view text) {
  return {{{std::string(text), Meaning::unbroken}}};
}

RichText missing(std::string_view reason) {
  return {{{"– ", Meaning::plain}, {"(" + std::string(reason) + ")", Meaning::reason}}};
}

RichText text_or_missing(std::string_view text, std::string_view reason) {
  return text.empty() ? missing(reason) : plain(text);
}

RichText badge(std::string_view word, Mood mood) {
  switch (mood) {
    case Mood::good:
      return {{{"✓ " + std::string(word), Meaning::good}}};
    case Mood::bad:
      return {{{"✗ " + std::string(word), Meaning::bad}}};
    case Mood::open:
      break;
  }
  return {{{"? " + std::string(word), Meaning::open}}};
}

Paragraph note(const RichText& text) {
  return {text, Paragraph::Role::note};
}

}  // namespace todbench
