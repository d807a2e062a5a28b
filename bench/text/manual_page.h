// SPDX-License-Identifier: GPL-3.0-or-later
// Manual page for man(1), as a value and as roff.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// Option, file or exit code, with its meaning.
struct ManualTerm {
  std::string term, meaning;
};

/// Section of a page.
struct ManualSection {
  std::string title;
  std::string text;  ///< paragraph before the terms; may be empty
  std::vector<ManualTerm> terms;
};

/// Page of section 1. All texts are plain and contain no markup.
struct ManualPage {
  std::string name;      ///< "todbench-fit"
  std::string sentence;  ///< purpose, without a full stop
  std::string date;      ///< date of the release, "2026-11-22"; the only text that is not escaped
  std::string version;   ///< "todbench 0.1.0"
  std::vector<std::string> synopsis;
  std::vector<ManualSection> sections;
  std::vector<std::string> see_also;  ///< names of pages of section 1
};

/// Escapes text for troff: backslashes, hyphens, quotes, and dots at the beginning of a line.
[[nodiscard]] std::string roff_text(std::string_view text);

/// Returns the page in the macros of man(7).
[[nodiscard]] std::string roff(const ManualPage& page);

}  // namespace todbench
