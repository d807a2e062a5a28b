// What the comparison of a plan can show, said before it is made.
#pragma once

#include <optional>
#include <string>

#include "bench/run/prediction.h"
#include "bench/session/plan.h"
#include "tod/planning.h"

namespace todbench {

/// Outlook of camera against twin: standard errors from the predicted uncertainty of the simulated design, that of the
/// camera scaled to its own number of phases; trials count as independent, so that it is the best case.
struct ComparisonForecast {
  std::optional<ComparisonOutlook> outlook;  ///< nothing where a contrast identifies no threshold
  std::string sentence;                      ///< a warning where the power stays below 80 %
};
[[nodiscard]] ComparisonForecast comparison_forecast(const Plan& plan, const PlanPrediction& prediction);

}  // namespace todbench
