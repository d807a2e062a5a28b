// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/text/manual_page.h"

#include <algorithm>
#include <cctype>

namespace todbench {
namespace {

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return result;
}

/// Adds a text line. Empty lines are left out, because troff turns them into gaps.
void add_line(std::string& page, std::string_view text) {
  if (!text.empty()) page += roff_text(text) + "\n";
}

std::string see_also_line(const std::vector<std::string>& names) {
  std::string lines;
  for (const std::string& name : names)
    lines += ".BR " + roff_text(name) + " (1)" + (&name == &names.back() ? "\n" : ",\n");
  return lines;
}

}  // namespace

std::string roff_text(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    const bool begins_line = result.empty() || result.back() == '\n';
    if (begins_line && (letter == '.' || letter == '\'')) result += "\\&";
    switch (letter) {
      case '\\':
        result += "\\e";
        break;
      case '-':
        result += "\\-";
        break;
      case '"':
        result += "\\(dq";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '`':
        result += "\\(ga";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      default:
        result += letter;
    }
  }
  return result;
}

std::string roff(const ManualPage& page) {
  std::string text =
      ".TH " + roff_text(upper(page.name)) + " 1 " + page.date + " \"" + roff_text(page.version) + "\"\n";
  text += ".SH NAME\n" + roff_text(page.name) + " \\- " + roff_text(page.sentence) + "\n.SH SYNOPSIS\n";
  for (const std::string& usage : page.synopsis) {
    const std::size_t blank = std::min(usage.find(' '), usage.size());
    if (&usage != &page.synopsis.front()) text += ".br\n";
    text += ".B " + roff_text(usage.substr(0, blank)) + "\n";
    if (blank < usage.size()) add_line(text, usage.substr(blank + 1));
  }
  for (const ManualSection& section : page.sections) {
    text += ".SH " + roff_text(upper(section.title)) + "\n";
    add_line(text, section.text);
    for (const ManualTerm& term : section.terms) {
      text += ".TP\n.B " + roff_text(term.term) + "\n";
      add_line(text, term.meaning);
    }
  }
  if (!page.see_also.empty()) text += ".SH SEE ALSO\n" + see_also_line(page.see_also);
  return text;
}

}  // namespace todbench
