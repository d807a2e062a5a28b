// SPDX-License-Identifier: GPL-3.0-or-later
// Ticks of an axis.
#pragma once

#include <string>
#include <vector>

#include "acquisition/base/result.h"

namespace todbench {

/// Scale of an axis.
enum class AxisScale {
  linear,
  logarithmic,
  dates,  ///< days since 1970-01-01, labelled "2026-11-27"
};

/// Axis of a plot.
struct PlotAxis {
  std::string label;  ///< with its unit: "Size S (mrad)"
  AxisScale scale = AxisScale::linear;
  double low = 0, high = 1;   ///< high > low; logarithmic: low > 0
  std::vector<double> ticks;  ///< labelled ticks; empty: chosen automatically
};

/// Tick of an axis.
struct Tick {
  double value = 0;
  std::string label;  ///< empty for a minor tick
};

/// Checks an axis. Errors: `invalid_input` (range empty, not finite, or not positive on a logarithmic axis).
[[nodiscard]] Result<void> validate(const PlotAxis& axis);

/// Returns the ticks inside the axis in increasing order, at most `most_labels` of them labelled. Linear: steps of 1, 2
/// or 5 times a power of ten. Logarithmic: decades, with 2, 5 or more multiples if there is room; minor ticks at
/// integer multiples. Dates: whole days, in linear steps.
[[nodiscard]] std::vector<Tick> axis_ticks(const PlotAxis& axis, int most_labels);

}  // namespace todbench
