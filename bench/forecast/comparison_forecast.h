// SPDX-License-Identifier: GPL-3.0-or-later
// Power of a comparison: of a plan before it is measured, and of two measured curves.
#pragma once

#include <optional>
#include <string>

#include "bench/forecast/prediction.h"
#include "bench/plan/plan.h"
#include "tod/comparison/comparison.h"
#include "tod/comparison/planning.h"

namespace todbench {

/// Expected power of a comparison.
struct ComparisonForecast {
  std::optional<ComparisonOutlook> outlook;  ///< empty if a contrast identifies no threshold
  std::string sentence;                      ///< begins with "warning" if the power is below 80 %
};

/// Forecasts the comparison of camera and twin. If camera and twin are measured at common phases, the paired ratio
/// decides, and the standard errors are those of this ratio. Otherwise the standard errors follow from the predicted
/// uncertainty of the simulated design. All standard errors are scaled to the camera's own number of phases.
[[nodiscard]] ComparisonForecast comparison_forecast(const Plan& plan, const PlanPrediction& prediction);

/// Forecasts the comparison of two curves at the contrasts of `comparison`. The standard errors follow from the
/// intervals of the curves, which include clusters.
[[nodiscard]] ComparisonForecast comparison_forecast(const TodCurve& a, const TodCurve& b,
                                                     const Comparison& comparison);

}  // namespace todbench
