// SPDX-License-Identifier: GPL-3.0-or-later
// Range of the integer values of a formula in a GenICam description, and whether its evaluation can raise SIGFPE.
//
// The processor raises SIGFPE if the smallest 64-bit integer is divided by -1, and the client (Aravis' evaluator)
// divides without a check. The analysis is conservative for the client's grammar: it assumes any value for parts that
// it cannot analyse.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

namespace todbench {

/// Range of integers, both limits included.
struct IntegerRange {
  std::int64_t low = std::numeric_limits<std::int64_t>::min();
  std::int64_t high = std::numeric_limits<std::int64_t>::max();
  bool operator==(const IntegerRange&) const = default;
};

/// Meaning of the operators in a formula.
enum class FormulaMode {
  whole,  ///< IntSwissKnife: / and % are integer operations
  real,   ///< all other formulas: only % is an integer operation
};

/// Range of a formula.
struct FormulaRange {
  IntegerRange value;
  bool may_trap = false;  ///< the evaluation can raise SIGFPE
};

/// Function that returns the range of a name in a formula; all integers if unknown.
using RangeOfName = std::function<IntegerRange(const std::string& name)>;

/// Returns the range of the formula. The time is proportional to the length of the formula.
[[nodiscard]] FormulaRange range_of_formula(std::string_view formula, FormulaMode mode, const RangeOfName& range_of);

/// Returns the smallest range that contains both ranges.
[[nodiscard]] IntegerRange hull(IntegerRange a, IntegerRange b);

}  // namespace todbench
