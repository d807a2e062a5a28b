// A page for man(1), as a value and as roff.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace todbench {

/// An option, a file or an exit code, and what it means.
struct ManualTerm {
  std::string term, meaning;
};

struct ManualSection {
  std::string title;
  std::string text;  ///< a paragraph before the terms; may be empty
  std::vector<ManualTerm> terms;
};

/// A page of section 1. All texts are plain: nothing in them is taken for markup.
struct ManualPage {
  std::string name;      ///< "todbench-fit"
  std::string sentence;  ///< what it does, without a full stop
  std::string date;      ///< of the release, "2026-11-22"; the one text that is written as it is
  std::string version;   ///< "todbench 0.1.0"
  std::vector<std::string> synopsis;
  std::vector<ManualSection> sections;
  std::vector<std::string> see_also;  ///< names of pages of section 1
};

/// Text that troff prints as it is: backslashes, hyphens, quotes, and dots at the beginning of a line.
[[nodiscard]] std::string roff_text(std::string_view text);

/// The page in the macros of man(7).
[[nodiscard]] std::string roff(const ManualPage& page);

}  // namespace todbench
