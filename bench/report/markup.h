// Text that is safe in HTML and SVG.
#pragma once

#include <string>
#include <string_view>

#include "acquisition/core/safe_text.h"

namespace todbench {

/// Finished markup, well-formed as XML. Plain text becomes markup only through escaped(), so that nothing enters a page
/// unescaped.
struct Markup {
  std::string text;

  Markup& operator+=(const Markup& more);
  friend Markup operator+(Markup left, const Markup& right) { return left += right; }
  [[nodiscard]] bool empty() const { return text.empty(); }
};

/// Markup written in the program itself.
[[nodiscard]] Markup literal(std::string_view markup);

/// valid_text() with & < > " ' as entities.
[[nodiscard]] Markup escaped(std::string_view plain);

/// <tag attributes>content</tag>. Attributes are written in the program: `class="x"`.
[[nodiscard]] Markup element(std::string_view tag, const Markup& content, std::string_view attributes = "");

}  // namespace todbench
