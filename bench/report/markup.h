// Text that is safe in HTML and SVG, and the few elements the report is made of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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

/// Text from outside as valid UTF-8: bytes that are none and control characters become U+FFFD.
[[nodiscard]] std::string valid_text(std::string_view plain);

/// valid_text() with & < > " ' as entities.
[[nodiscard]] Markup escaped(std::string_view plain);

/// <tag attributes>content</tag>. Attributes are written in the program: `class="x"`.
[[nodiscard]] Markup element(std::string_view tag, const Markup& content, std::string_view attributes = "");

/// A table whose header names units. Cells are markup; rows are as long as the header. The first column is the row's
/// header.
struct MarkupTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<Markup>> rows;
};
[[nodiscard]] Markup table(const MarkupTable& table);

/// Two columns, name and value: <table> with row headers only.
struct NamedValue {
  std::string name;
  Markup value;
};
[[nodiscard]] Markup table_of_values(const std::string& caption, const std::vector<NamedValue>& values);

/// Text that is not broken over two lines: a number with its interval.
[[nodiscard]] Markup unbroken(std::string_view plain);

/// A dash with the reason why there is no value.
[[nodiscard]] Markup missing(std::string_view reason);

/// `plain` escaped, or missing(reason) when it is empty.
[[nodiscard]] Markup text_or_missing(std::string_view plain, std::string_view reason);

}  // namespace todbench
