// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/base/number_range.h"

#include <fmt/format.h>

#include <cmath>

namespace todbench {

bool NumberRange::contains(double value) const {
  // Smaller than any quantity in any unit; its reciprocal or square would overflow.
  constexpr double least_magnitude = 1e-100;
  if (!std::isfinite(value) || (value != 0 && std::abs(value) < least_magnitude)) return false;
  return (low_edge == Edge::excluded ? value > low : value >= low) && value <= high;
}

std::string NumberRange::describe() const {
  const bool no_low = low == std::numeric_limits<double>::lowest();
  const bool no_high = high == std::numeric_limits<double>::max();
  if (no_low) return no_high ? "a finite number" : fmt::format("a number up to {:g}", high);
  if (low_edge == Edge::excluded)
    return no_high ? fmt::format("a number above {:g}", low) : fmt::format("a number above {:g} up to {:g}", low, high);
  return no_high ? fmt::format("a number of {:g} or more", low) : fmt::format("a number from {:g} to {:g}", low, high);
}

}  // namespace todbench
