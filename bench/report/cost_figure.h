// The measured frontier of accuracy and time as a figure.
#pragma once

#include "bench/report/svg_plot.h"

namespace todbench {

/// One measured point of a cost frontier, as a figure needs it.
struct CostMark {
  std::string knob;
  double wall_s = 0, error_percent = 0;
  bool chosen = false;
};

/// Error against wall time, both logarithmic, one series per group of knobs, the chosen point apart. Errors below
/// 0.001 % are drawn at 0.001 %. Precondition: at least one mark with a wall time > 0.
[[nodiscard]] Plot cost_plot(const std::vector<CostMark>& marks);

}  // namespace todbench
