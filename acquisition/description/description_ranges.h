// Which whole numbers the nodes of a description can have for values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/description/description_nodes.h"
#include "acquisition/description/formula_range.h"

namespace todbench {

/// A whole number as descriptions have it, in decimal or after 0x; what is behind it does not count, and none is 0.
[[nodiscard]] std::int64_t whole_number(const std::string& text);

/// Of nodes without cycles. Keeps what it has found and a reference to the nodes.
class DescriptionRanges {
 public:
  explicit DescriptionRanges(const DescriptionNodes& nodes) : nodes_(nodes), found_(nodes.nodes.size()) {}

  /// What a reference to this name can have for a value.
  [[nodiscard]] IntegerRange range_of(const std::string& name);
  /// Whether a formula of the node can end the program.
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
