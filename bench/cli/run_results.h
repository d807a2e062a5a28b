// SPDX-License-Identifier: GPL-3.0-or-later
// Output of a finished run, the same for every command that measures.
#pragma once

#include "bench/cli/console.h"
#include "bench/run/experiment.h"

namespace todbench {

/// Prints curve, comparison, uncertainty, measures, bill and verdict of a measured run, or its JSON object, and returns
/// the exit code. `loaded`: plan whose forecast the bill compares with the run; null: none.
[[nodiscard]] int show_measured(Console& console, const ExperimentOutcome& outcome, const LoadedPlan* loaded = nullptr);

}  // namespace todbench
