// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges of the integer values of a description's nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/description/description_nodes.h"
#include "acquisition/description/formula_range.h"

namespace todbench {

/// Parses an integer as in descriptions: decimal, or hexadecimal after 0x. Ignores later characters; returns 0 if there
/// is no number.
[[nodiscard]] std::int64_t whole_number(const std::string& text);

/// Computes the ranges of nodes without circular references. Caches its results and keeps a reference to the nodes.
class DescriptionRanges {
 public:
  explicit DescriptionRanges(const DescriptionNodes& nodes) : nodes_(nodes), found_(nodes.nodes.size()) {}

  /// Returns the range of the values of the node with this name; all integers if there is no such node.
  [[nodiscard]] IntegerRange range_of(const std::string& name);
  /// Returns whether a formula of the node can raise SIGFPE, which would end the program.
  [[nodiscard]] bool may_trap(const DescriptionNode& node);

 private:
  [[nodiscard]] IntegerRange range_of_node(std::size_t index);
  [[nodiscard]] IntegerRange computed(const DescriptionNode& node);
  [[nodiscard]] FormulaRange formula_of(const DescriptionNode& node, const std::string& formula);
  [[nodiscard]] IntegerRange range_in_formula(const DescriptionNode& node, FormulaMode mode, const std::string& name);

  const DescriptionNodes& nodes_;
  std::vector<std::optional<IntegerRange>> found_;
};

}  // namespace todbench
