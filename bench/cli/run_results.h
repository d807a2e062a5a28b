// SPDX-License-Identifier: GPL-3.0-or-later
// Output of a finished run, the same for every command that measures or simulates.
#pragma once

#include "bench/cli/console.h"
#include "bench/report/accuracy_bill.h"
#include "bench/run/experiment.h"
#include "bench/text/json.h"

namespace todbench {

/// Parts of the output that only some commands have.
struct RunShown {
  bool curve = true;     ///< prints the curve; the JSON object always contains it
  bool effects = false;  ///< prints the effects of the simulated sensor
  bool why = false;      ///< prints the reason for each neutral effect
};

/// Prints the curve, comparison, uncertainty, measures, bill and verdict of a run, or its JSON object. Returns the exit
/// code.
[[nodiscard]] int show_run(Console& console, const ExperimentOutcome& outcome, const RunShown& shown = {});
/// Prints the text of show_run().
void print_run(const Console& console, const ExperimentOutcome& outcome, const RunShown& shown);
/// Prints the session folder and, after an early end, its reason. Returns the exit code.
[[nodiscard]] int finish_run(Console& console, const ExperimentOutcome& outcome);

/// Prints the curve as a table.
void print_curve(const Console& console, const TodCurve& curve);
[[nodiscard]] AccuracyBill bill_of(const ExperimentOutcome& outcome);
/// Adds the verdict to the JSON of a run.
void add_verdict(Json& json, const Verdict& verdict);

}  // namespace todbench
