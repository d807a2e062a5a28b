// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/sweep/constraint.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

namespace todbench {

using Values = std::function<std::optional<double>(std::string_view name)>;

/// True is 1, false is 0; an unknown value is NaN and makes every comparison false.
struct Constraint::Node {
  std::string operation;  ///< empty: a number or a name
  std::string name;
  double number = 0;
  std::shared_ptr<const Node> left, right;

  [[nodiscard]] double evaluated(const Values& values) const {
    if (operation.empty()) return name.empty() ? number : values(name).value_or(std::nan(""));
    const double a = left->evaluated(values), b = right->evaluated(values);
    if (operation == "+") return a + b;
    if (operation == "-") return a - b;
    if (operation == "*") return a * b;
    if (operation == "/") return a / b;
    if (operation == "and") return a == 1 && b == 1 ? 1 : 0;
    if (operation == "or") return a == 1 || b == 1 ? 1 : 0;
    if (std::isnan(a) || std::isnan(b)) return 0;
    if (operation == "<") return a < b ? 1 : 0;
    if (operation == "<=") return a <= b ? 1 : 0;
    if (operation == ">") return a > b ? 1 : 0;
    if (operation == ">=") return a >= b ? 1 : 0;
    if (operation == "==") return a == b ? 1 : 0;
    return a != b ? 1 : 0;
  }
};

/// Recursive descent parser, one function per precedence level; the depth of parentheses is limited.
class ConstraintParser {
 public:
  using Pointer = std::shared_ptr<const Constraint::Node>;

  explicit ConstraintParser(std::string_view text) : text_(text) {}

  Result<Constraint> parsed() {
    Pointer root = level(0);
    skip_blanks();
    if (!problem_ && place_ < text_.size()) note("expected an operator");
    if (!problem_ && !compares_) note("expected a comparison");
    if (problem_) {
      return fail(ErrorCode::invalid_input,
                  fmt::format("condition '{}': {} at character {}", text_, problem_->first, problem_->second + 1));
    }
    Constraint constraint;
    constraint.text_ = std::string(text_);
    constraint.names_ = std::move(names_);
    constraint.root_ = std::move(root);
    return constraint;
  }

 private:
  static constexpr int deepest = 50;
  static constexpr std::array<std::array<std::string_view, 6>, 5> levels{
      {{"or"}, {"and"}, {"<=", ">=", "==", "!=", "<", ">"}, {"+", "-"}, {"*", "/"}}};

  void note(std::string sentence) {
    if (!problem_) problem_ = {std::move(sentence), place_};
  }
  void skip_blanks() {
    while (place_ < text_.size() && text_[place_] == ' ') ++place_;
  }
  static bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.'; }

  /// Consumes the next operator of this level.
  std::string_view taken(std::size_t at_level) {
    skip_blanks();
    for (const std::string_view word : levels[at_level]) {
      if (word.empty() || !text_.substr(place_).starts_with(word)) continue;
      const std::size_t end = place_ + word.size();
      if (in_word(word.front()) && end < text_.size() && in_word(text_[end])) continue;
      place_ = end;
      return word;
    }
    return {};
  }

  Pointer level(std::size_t at_level) {
    if (at_level == levels.size()) return atom();
    Pointer left = level(at_level + 1);
    while (!problem_) {
      const std::string_view word = taken(at_level);
      if (word.empty()) break;
      if (at_level == 2) compares_ = true;
      Constraint::Node node;
      node.operation = std::string(word);
      node.left = left;
      node.right = level(at_level + 1);
      left = std::make_shared<const Constraint::Node>(std::move(node));
      if (++operators_ > 1000) note("the condition is too long");
    }
    return left;
  }

  Pointer atom() {
    skip_blanks();
    Constraint::Node node;
    if (place_ < text_.size() && text_[place_] == '(') {
      if (++depth_ > deepest) note("too many parentheses");
      ++place_;
      Pointer inside = problem_ ? nullptr : level(0);
      skip_blanks();
      if (place_ >= text_.size() || text_[place_] != ')') note("expected ')'");
      ++place_;
      --depth_;
      return inside;
    }
    const char* const end = text_.data() + text_.size();
    const auto [after, failure] = std::from_chars(text_.data() + place_, end, node.number);
    if (failure == std::errc() && std::isfinite(node.number) && (after == end || !in_word(*after))) {
      place_ = static_cast<std::size_t>(after - text_.data());
      return std::make_shared<const Constraint::Node>(std::move(node));
    }
    const std::size_t begin = place_;
    while (place_ < text_.size() && in_word(text_[place_])) ++place_;
    node.name = std::string(text_.substr(begin, place_ - begin));
    if (node.name.empty()) note("expected a name or a number");
    names_.push_back(node.name);
    return std::make_shared<const Constraint::Node>(std::move(node));
  }

  std::string_view text_;
  std::size_t place_ = 0;
  int depth_ = 0, operators_ = 0;
  bool compares_ = false;
  std::vector<std::string> names_;
  std::optional<std::pair<std::string, std::size_t>> problem_;
};

Result<Constraint> Constraint::parse(std::string_view text) {
  return ConstraintParser(text).parsed();
}

bool Constraint::holds(const Values& value) const {
  return root_->evaluated(value) == 1;
}

}  // namespace todbench
