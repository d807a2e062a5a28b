// SPDX-License-Identifier: GPL-3.0-or-later
// Output of a finished run, the same for every command that measures.
#pragma once

#include "bench/cli/console.h"
#include "bench/run/experiment.h"

namespace todbench {

/// Whether the bill of a run stands beside its forecast.
enum class BillForecast { left_out, shown };

/// Prints curve, comparison, uncertainty, measures, bill and verdict of a measured run, or its JSON object, and returns
/// the exit code.
[[nodiscard]] int show_measured(Console& console, const ExperimentOutcome& outcome,
                                BillForecast forecast = BillForecast::left_out);

}  // namespace todbench
