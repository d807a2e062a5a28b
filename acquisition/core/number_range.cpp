#include "acquisition/core/number_range.h"

#include <fmt/format.h>

#include <cmath>

namespace todbench {

bool NumberRange::contains(double value) const {
  if (!std::isfinite(value)) return false;
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
