// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals, and values with their interval.
#pragma once

#include <optional>

namespace todbench {

/// An interval. A side without a value is unbounded.
struct Interval {
  std::optional<double> low, high;
};

/// A value with its 95 % interval, bounded on both sides.
struct Estimate {
  double value = 0, low = 0, high = 0;
  [[nodiscard]] Interval interval() const { return {low, high}; }
};

}  // namespace todbench
