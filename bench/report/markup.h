// SPDX-License-Identifier: GPL-3.0-or-later
// Text that is safe in HTML and SVG.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/base/safe_text.h"

namespace todbench {

/// Finished markup, well-formed as XML. Plain text becomes markup only through escaped(), so no text reaches a page
/// unescaped.
struct Markup {
  std::string text;

  Markup& operator+=(const Markup& more);
  friend Markup operator+(Markup left, const Markup& right) { return left += right; }
  [[nodiscard]] bool empty() const { return text.empty(); }
};

/// Returns markup written in the program itself.
[[nodiscard]] Markup literal(std::string_view markup);

/// Returns valid_text() with & < > " ' as entities.
[[nodiscard]] Markup escaped(std::string_view plain);

/// Returns <tag attributes>content</tag>. Attributes are literals of the program: `class="x"`.
[[nodiscard]] Markup element(std::string_view tag, const Markup& content, std::string_view attributes = "");

}  // namespace todbench
