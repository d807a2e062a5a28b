// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions between parameters: "detector_um <= pitch_um and netd_k < 0.1".
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Condition with numbers, names, + - * / and parentheses, compared by < <= > >= == !=, joined by `and` and `or`
/// (`and` binds closer). Immutable, thread-safe.
class Constraint {
 public:
  /// Parses a condition. Errors: `invalid_input` with the position in the text.
  [[nodiscard]] static Result<Constraint> parse(std::string_view text);
  /// Returns the text of the condition.
  [[nodiscard]] const std::string& text() const { return text_; }
  /// Returns the names in the condition.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Returns whether the condition is true for these values; false also if a name has no value.
  [[nodiscard]] bool holds(const std::function<std::optional<double>(std::string_view name)>& value) const;

 private:
  struct Node;
  friend class ConstraintParser;
  std::string text_;
  std::vector<std::string> names_;
  std::shared_ptr<const Node> root_;
};

}  // namespace todbench
