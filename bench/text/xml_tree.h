// SPDX-License-Identifier: GPL-3.0-or-later
// Small XML document as a tree: elements, attributes and text of foreign files. Document type declarations are
// rejected, so a file can neither define entities nor name other files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Element with its children.
struct XmlElement {
  std::string name;  ///< name without the prefix of its namespace
  std::string text;  ///< own text without the text of children, trimmed
  std::vector<std::pair<std::string, std::string>> attributes{};
  std::vector<XmlElement> children{};

  /// Returns the first child with this name; null: none.
  [[nodiscard]] const XmlElement* child(std::string_view wanted) const;
  /// Returns the text of the first child with this name; empty: none.
  [[nodiscard]] std::string text_of(std::string_view wanted) const;
};

/// Limits of a document.
struct XmlLimits {
  std::size_t bytes = 8u << 20;
  std::size_t elements = 100'000;
  int depth = 64;
};

/// Parses a document in UTF-8. The memory used is at most about 100 bytes per element, plus the size of the text.
/// Errors: `invalid_input` with the line: larger than the limits, a document type declaration, not well-formed.
[[nodiscard]] Result<XmlElement> parse_xml(std::string_view text, const XmlLimits& limits = {});

}  // namespace todbench
