// The measured frontier of accuracy and time as figures and as a table.
#pragma once

#include <string>

#include "bench/report/document.h"
#include "bench/report/plot.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// What a result may be off by over its wall time: tolerance, draws, trials and planner, the chosen point apart. Both
/// axes are logarithmic. Nothing measured: axes without points.
[[nodiscard]] Plot cost_result_plot(const CostFrontier& frontier);
/// The error of each numerical knob alone over wall time; below 0.001 % it is drawn at 0.001 %.
[[nodiscard]] Plot cost_knob_plot(const CostFrontier& frontier);
/// Both figures, one above the other, as a file of its own.
[[nodiscard]] Result<std::string> cost_document(const CostFrontier& frontier);

/// Figures, table and notes.
[[nodiscard]] Section cost_section(const CostFrontier& frontier);

}  // namespace todbench
