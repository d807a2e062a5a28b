// SPDX-License-Identifier: GPL-3.0-or-later
// Measured trade-off between accuracy and computing time (frontier) as figures and as a table.
#pragma once

#include <string>

#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// Returns the plot of the error of a result over its computing time for tolerance, draws, trials and planner; the
/// chosen point is marked. Both axes are logarithmic. The axes are empty without measurements.
[[nodiscard]] Plot cost_result_plot(const CostFrontier& frontier);
/// Returns the plot of the error of each numerical parameter over its computing time; errors below 0.001 % are drawn at
/// 0.001 %.
[[nodiscard]] Plot cost_knob_plot(const CostFrontier& frontier);
/// Returns both figures, one above the other, as an SVG file.
[[nodiscard]] Result<std::string> cost_document(const CostFrontier& frontier);

/// Returns figures, table and notes.
[[nodiscard]] Section cost_section(const CostFrontier& frontier);

}  // namespace todbench
