// Conditions between parameters: "detector_um <= pitch_um and netd_k < 0.1".
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

/// A condition of numbers, names, + - * / and parentheses, compared by < <= > >= == !=, joined by `and` and `or`
/// (`and` binds closer). Immutable, thread-safe.
class Constraint {
 public:
  /// `invalid_input` in one sentence with the place in the text.
  [[nodiscard]] static Result<Constraint> parse(std::string_view text);
  [[nodiscard]] const std::string& text() const { return text_; }
  /// The names it asks for.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// False also where a name has no number.
  [[nodiscard]] bool holds(const std::function<std::optional<double>(std::string_view name)>& value) const;

 private:
  struct Node;
  friend class ConstraintParser;
  std::string text_;
  std::vector<std::string> names_;
  std::shared_ptr<const Node> root_;
};

}  // namespace todbench
