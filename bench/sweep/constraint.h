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

/// A condition with numbers, names, + - * / and parentheses, compared by < <= > >= == !=, joined by `and` and `or`
/// (`and` binds closer). Immutable, thread-safe.
class Constraint {
 public:
  /// Errors: `invalid_input` in one sentence with the place in the text.
  [[nodiscard]] static Result<Constraint> parse(std::string_view text);
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The names in the condition.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// False also if a name has no number.
  [[nodiscard]] bool holds(const std::function<std::optional<double>(std::string_view name)>& value) const;

 private:
  struct Node;
  friend class ConstraintParser;
  std::string text_;
  std::vector<std::string> names_;
  std::shared_ptr<const Node> root_;
};

}  // namespace todbench
