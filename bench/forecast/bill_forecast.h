// SPDX-License-Identifier: GPL-3.0-or-later
// Forecast of the accuracy bill before a run.
#pragma once

#include "acquisition/base/result.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/loaded_plan.h"
#include "bench/report/accuracy_bill.h"

namespace todbench {

/// Forecasts the bill of a measurement: changes of the target, location of the plate and contrasts, and presentations
/// of each contrast, as bench_time() counts them, with the predicted half-widths, and the rows of the budget that no
/// presentation reduces. `total_s`: bench time without computing time. Empty for a simulated scene, whose time depends
/// only on the processor. Errors: those of predict_plan() and curve_uncertainty().
[[nodiscard]] Result<AccuracyBill> bill_forecast(const Plan& plan, const ExperimentInputs& inputs);
/// Loads the inputs first. Errors: also those of experiment_inputs().
[[nodiscard]] Result<AccuracyBill> bill_forecast(const LoadedPlan& loaded);

}  // namespace todbench
