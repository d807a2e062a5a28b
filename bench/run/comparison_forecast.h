// What a comparison can show: of a plan, said before it is made, and of two curves that have been measured.
#pragma once

#include <optional>
#include <string>

#include "bench/plan/plan.h"
#include "bench/run/prediction.h"
#include "tod/comparison/comparison.h"
#include "tod/comparison/planning.h"

namespace todbench {

struct ComparisonForecast {
  std::optional<ComparisonOutlook> outlook;  ///< nothing where a contrast identifies no threshold
  std::string sentence;                      ///< begins with "warning" where the power stays below 80 %
};

/// Outlook of camera against twin: standard errors from the predicted uncertainty of the simulated design, that of the
/// camera scaled to its own number of phases.
[[nodiscard]] ComparisonForecast comparison_forecast(const Plan& plan, const PlanPrediction& prediction);

/// Of two curves, at the contrasts of their comparison: standard errors from their intervals, clusters included.
[[nodiscard]] ComparisonForecast comparison_forecast(const TodCurve& a, const TodCurve& b,
                                                     const Comparison& comparison);

}  // namespace todbench
