// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/description/formula_range.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <optional>

#include "acquisition/base/safe_text.h"

namespace todbench {
namespace {

__extension__ using Wide = __int128;

constexpr auto smallest = std::numeric_limits<std::int64_t>::min();
constexpr auto largest = std::numeric_limits<std::int64_t>::max();
constexpr IntegerRange truth{0, 1};
/// Largest integer up to which all integers are exact in a 64-bit real.
constexpr std::int64_t exact_reals = std::int64_t{1} << 53;
/// Deepest nesting of parentheses and signs.
constexpr int most_nesting = 60;

bool holds(IntegerRange range, std::int64_t value) {
  return range.low <= value && value <= range.high;
}

bool is_any(IntegerRange range) {
  return range == IntegerRange{};
}

/// Numbers that do not fit wrap around to any other number.
IntegerRange fitted(Wide low, Wide high) {
  if (low < smallest || high > largest) return {};
  return {static_cast<std::int64_t>(low), static_cast<std::int64_t>(high)};
}

Wide magnitude(IntegerRange range) {
  return std::max(-Wide{range.low}, Wide{range.high});
}

IntegerRange product(IntegerRange a, IntegerRange b) {
  const std::array ends{Wide{a.low} * b.low, Wide{a.low} * b.high, Wide{a.high} * b.low, Wide{a.high} * b.high};
  const auto [low, high] = std::minmax_element(ends.begin(), ends.end());
  return fitted(*low, *high);
}

/// Range of all bits up to the highest one of either operand.
IntegerRange bits_of(IntegerRange a, IntegerRange b) {
  if (a.low < 0 || b.low < 0) return {};
  const auto highest = static_cast<std::uint64_t>(std::max(a.high, b.high));
  return {0, highest == 0 ? 0 : static_cast<std::int64_t>(~std::uint64_t{0} >> std::countl_zero(highest))};
}

IntegerRange shifted_left(IntegerRange a, IntegerRange by) {
  if (a.low < 0 || by.low < 0 || by.high > 62) return {};
  return fitted(Wide{a.low} << by.low, Wide{a.high} << by.high);
}

IntegerRange masked(IntegerRange a, IntegerRange b) {
  if (a.low < 0 && b.low < 0) return {};
  if (a.low < 0) return {0, b.high};
  if (b.low < 0) return {0, a.high};
  return {0, std::min(a.high, b.high)};
}

struct Operator {
  std::string_view text;
  int precedence;
};
/// Longer operators first. Precedence of the client's evaluator; all are left-associative except **.
constexpr std::array operators{Operator{"**", 120}, Operator{"||", 10}, Operator{"&&", 20}, Operator{"<>", 70},
                               Operator{"<=", 80},  Operator{">=", 80}, Operator{">>", 90}, Operator{"<<", 90},
                               Operator{"|", 40},   Operator{"^", 50},  Operator{"&", 60},  Operator{"=", 70},
                               Operator{"<", 80},   Operator{">", 80},  Operator{"-", 100}, Operator{"+", 100},
                               Operator{"%", 110},  Operator{"/", 110}, Operator{"*", 110}};
constexpr int least_precedence = 10;
constexpr int power_precedence = 120;

constexpr std::array<std::string_view, 18> functions{"sin",   "cos",   "sgn",  "neg",  "atan", "tan",
                                                     "abs",   "exp",   "ln",   "lg",   "sqrt", "trunc",
                                                     "round", "floor", "ceil", "asin", "acos", "e"};

class Parser {
 public:
  Parser(std::string_view text, FormulaMode mode, const RangeOfName& range_of)
      : text_(text), mode_(mode), range_of_(range_of) {}

  [[nodiscard]] FormulaRange run() {
    const IntegerRange value = ternary();
    skip_blanks();
    if (!text_.substr(at_).empty()) understood_ = false;
    return {understood_ ? value : IntegerRange{}, may_trap_ || !understood_};
  }

 private:
  [[nodiscard]] IntegerRange ternary();
  [[nodiscard]] IntegerRange binary(int least);
  [[nodiscard]] IntegerRange unary();
  [[nodiscard]] IntegerRange primary();
  [[nodiscard]] IntegerRange number();
  [[nodiscard]] IntegerRange name();
  [[nodiscard]] IntegerRange call(const std::string& function);
  [[nodiscard]] IntegerRange combined(std::string_view op, IntegerRange a, IntegerRange b);
  [[nodiscard]] IntegerRange divided(std::string_view op, IntegerRange a, IntegerRange b);
  [[nodiscard]] const Operator* next_operator() const;

  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  [[nodiscard]] bool take(char wanted) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != wanted) return false;
    ++at_;
    return true;
  }
  [[nodiscard]] IntegerRange lost() {
    understood_ = false;
    at_ = text_.size();
    return {};
  }

  std::string_view text_;
  FormulaMode mode_;
  const RangeOfName& range_of_;
  std::size_t at_ = 0;
  int nesting_ = 0;
  bool understood_ = true, may_trap_ = false;
};

IntegerRange Parser::ternary() {
  if (++nesting_ > most_nesting) return lost();
  IntegerRange value = binary(least_precedence);
  if (take('?')) {
    const IntegerRange yes = ternary();
    if (!take(':')) return lost();
    value = hull(yes, ternary());
  }
  --nesting_;
  return value;
}

const Operator* Parser::next_operator() const {
  const auto found = std::find_if(operators.begin(), operators.end(),
                                  [&](const Operator& op) { return text_.substr(at_).starts_with(op.text); });
  return found == operators.end() ? nullptr : &*found;
}

IntegerRange Parser::binary(int least) {
  IntegerRange left = unary();
  for (;;) {
    skip_blanks();
    const Operator* op = next_operator();
    if (op == nullptr || op->precedence < least) return left;
    at_ += op->text.size();
    const IntegerRange right = binary(op->precedence == power_precedence ? op->precedence : op->precedence + 1);
    left = combined(op->text, left, right);
  }
}

IntegerRange Parser::unary() {
  if (++nesting_ > most_nesting) return lost();
  IntegerRange value;
  if (take('-')) {
    const IntegerRange inner = unary();
    value = fitted(-Wide{inner.high}, -Wide{inner.low});
  } else if (take('+')) {
    value = unary();
  } else if (take('~')) {
    const IntegerRange inner = unary();
    value = {~inner.high, ~inner.low};
  } else {
    value = primary();
  }
  --nesting_;
  return value;
}

IntegerRange Parser::primary() {
  if (take('(')) {
    const IntegerRange value = ternary();
    return take(')') ? value : lost();
  }
  if (at_ >= text_.size()) return lost();
  const auto first = static_cast<unsigned char>(text_[at_]);
  if (std::isdigit(first) != 0) return number();
  if (std::isalpha(first) != 0 || first == '_' || first == '.') return name();
  return lost();
}

IntegerRange Parser::number() {
  // As the evaluator reads it: the longer one of an integer with the prefixes of C and a real number.
  const std::string rest(text_.substr(at_));
  char* whole_end = nullptr;
  const std::int64_t whole = std::strtoll(rest.c_str(), &whole_end, 0);
  double real = 0;
  const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), real);
  const auto whole_length = static_cast<std::size_t>(whole_end - rest.c_str());
  const auto real_length = parsed.ec == std::errc() ? static_cast<std::size_t>(parsed.ptr - rest.data()) : 0;
  at_ += std::max(whole_length, real_length);
  // The evaluator may convert an integer through a real, which changes larger ones.
  if (whole > exact_reals || !(real < static_cast<double>(exact_reals))) return {};
  if (whole_length >= real_length) return {whole, whole};
  return {static_cast<std::int64_t>(real), static_cast<std::int64_t>(real) + 1};
}

IntegerRange Parser::name() {
  std::size_t end = at_;
  while (end < text_.size() &&
         (std::isalnum(static_cast<unsigned char>(text_[end])) != 0 || text_[end] == '_' || text_[end] == '.')) {
    ++end;
  }
  const std::string word(text_.substr(at_, end - at_));
  at_ = end;
  const std::string lower = lower_case(word);
  skip_blanks();
  if (std::find(functions.begin(), functions.end(), lower) != functions.end() && at_ < text_.size() &&
      text_[at_] == '(') {
    return call(lower);
  }
  return range_of_(word);
}

IntegerRange Parser::call(const std::string& function) {
  if (!take('(')) return lost();
  const IntegerRange value = ternary();
  while (take(',')) static_cast<void>(ternary());
  if (!take(')')) return lost();
  if (function == "sgn") return {-1, 1};
  if (function == "neg") return fitted(-Wide{value.high}, -Wide{value.low});
  if (function == "abs" && value.low > smallest) return fitted(value.low > 0 ? Wide{value.low} : 0, magnitude(value));
  return {};
}

IntegerRange Parser::divided(std::string_view op, IntegerRange a, IntegerRange b) {
  if (op == "/" && mode_ == FormulaMode::real) return {};
  if (holds(a, smallest) && holds(b, -1)) may_trap_ = true;
  return fitted(-magnitude(a), magnitude(a));
}

IntegerRange Parser::combined(std::string_view op, IntegerRange a, IntegerRange b) {
  if (op == "/" || op == "%") return divided(op, a, b);
  if (op == "||" || op == "&&" || op == "=" || op == "<>" || op == "<" || op == ">" || op == "<=" || op == ">=") {
    return truth;
  }
  if (op == "&") return masked(a, b);
  if (op == ">>") return {std::min<std::int64_t>(a.low, 0), std::max<std::int64_t>(a.high, 0)};
  // Infinities and NaN come from operands with any value.
  if (is_any(a) || is_any(b) || op == "**") return {};
  if (op == "+") return fitted(Wide{a.low} + b.low, Wide{a.high} + b.high);
  if (op == "-") return fitted(Wide{a.low} - b.high, Wide{a.high} - b.low);
  if (op == "*") return product(a, b);
  if (op == "<<") return shifted_left(a, b);
  return bits_of(a, b);
}

}  // namespace

IntegerRange hull(IntegerRange a, IntegerRange b) {
  return {std::min(a.low, b.low), std::max(a.high, b.high)};
}

FormulaRange range_of_formula(std::string_view formula, FormulaMode mode, const RangeOfName& range_of) {
  FormulaRange found = Parser(formula, mode, range_of).run();
  // A formula without a division cannot trap, even if it was not understood.
  const bool divides = formula.find('%') != std::string_view::npos ||
                       (mode == FormulaMode::whole && formula.find('/') != std::string_view::npos);
  found.may_trap = found.may_trap && divides;
  return found;
}

}  // namespace todbench
