// Where an axis has its ticks.
#pragma once

#include <string>
#include <vector>

#include "acquisition/core/result.h"

namespace todbench {

enum class AxisScale { linear, logarithmic };

struct PlotAxis {
  std::string label;  ///< with its unit: "Size S (mrad)"
  AxisScale scale = AxisScale::linear;
  double low = 0, high = 1;   ///< high > low; logarithmic: low > 0
  std::vector<double> ticks;  ///< labelled ticks; empty: chosen
};

struct Tick {
  double value = 0;
  std::string label;  ///< empty for a minor tick
};

/// `invalid_input` for a range that is empty, not finite, or not positive on a logarithmic axis.
[[nodiscard]] Result<void> validate(const PlotAxis& axis);

/// Ticks inside the axis, increasing; at most `most_labels` of them labelled. Linear: steps of 1, 2 or 5 times a power
/// of ten. Logarithmic: decades, filled with 2 and 5 or more where there is room, minor ticks at the whole multiples.
[[nodiscard]] std::vector<Tick> axis_ticks(const PlotAxis& axis, int most_labels);

}  // namespace todbench
