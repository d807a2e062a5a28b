// Which whole numbers a formula of a GenICam description can have for values, and whether finding one can trap.
//
// The processor raises SIGFPE where the smallest number of 64 bits is divided by -1, and the client (Aravis' evaluator)
// divides without looking. Sound for its grammar: what is not understood has any value.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

namespace todbench {

/// Inclusive.
struct IntegerRange {
  std::int64_t low = std::numeric_limits<std::int64_t>::min();
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
  bool operator==(const IntegerRange&) const = default;
};

enum class FormulaMode {
  whole,  ///< IntSwissKnife: / and % divide whole numbers
  real,   ///< all others: only % does
};

struct FormulaRange {
  IntegerRange value;
  bool may_trap = false;
};

/// What a name in a formula can be; all numbers where it is not known.
using RangeOfName = std::function<IntegerRange(const std::string& name)>;

/// In proportion to the length of the formula.
[[nodiscard]] FormulaRange range_of_formula(std::string_view formula, FormulaMode mode, const RangeOfName& range_of);

/// The range that holds both.
[[nodiscard]] IntegerRange hull(IntegerRange a, IntegerRange b);

}  // namespace todbench
