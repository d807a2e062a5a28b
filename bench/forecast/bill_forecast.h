// SPDX-License-Identifier: GPL-3.0-or-later
// Forecast of the accuracy bill before a run.
#pragma once

#include "acquisition/base/result.h"
#include "bench/forecast/prediction.h"
#include "bench/plan/loaded_plan.h"
#include "bench/report/accuracy_bill.h"

namespace todbench {

/// Forecasts the bill of a measurement. The bill contains the times of target changes, location of the plate and
/// contrasts, presentations of each contrast, and physical measures, as bench_time() counts them. The bill also has the
/// predicted half-widths, the rows of the budget that presentations do not reduce, the least time for the limits on
/// acuity, and the effects left out. `total_s`: bench time of the run, without warm-up and computing. Empty for a
/// simulated scene, which is as fast as the processor. Errors: those of predict_plan() and curve_uncertainty().
[[nodiscard]] Result<AccuracyBill> bill_forecast(const Plan& plan, const ExperimentInputs& inputs);
/// Loads the inputs of the plan and forecasts with the overload above. Errors: also those of experiment_inputs().
[[nodiscard]] Result<AccuracyBill> bill_forecast(const LoadedPlan& loaded);

}  // namespace todbench
