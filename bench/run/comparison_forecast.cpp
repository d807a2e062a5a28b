#include "bench/run/comparison_forecast.h"

#include <cmath>

#include "bench/session/plan_options.h"
#include "bench/session/text.h"

namespace todbench {

ComparisonForecast comparison_forecast(const Plan& plan, const PlanPrediction& prediction) {
  const double margin = comparison_options(plan).margin_percent;
  const std::string margin_text = number_text(margin) + " %";
  const double trials_b =
      static_cast<double>(prediction.figures.trials) / static_cast<double>(plan.target.delta_t_k.size());
  const double share = static_cast<double>(plan.target.phases) / plan.simulation.phases;  // of the camera's trials
  std::vector<PlannedComparison> contrasts;
  for (const ContrastPrediction& contrast : prediction.contrasts) {
    if (!contrast.uncertainty_percent || !(*contrast.uncertainty_percent > 0)) {
      return {std::nullopt, "the comparison with the twin cannot be decided at " + number_text(contrast.delta_t_k) +
                                " K: no threshold is expected among the sizes of the plates"};
    }
    const double se_b = std::log1p(*contrast.uncertainty_percent / 100) / 1.96;
    contrasts.push_back({.delta_t_k = contrast.delta_t_k,
                         .se_ln_a = se_b / std::sqrt(share),
                         .se_ln_b = se_b,
                         .trials_a = trials_b * share,
                         .trials_b = trials_b});
  }
  if (contrasts.empty()) return {};
  const ComparisonOutlook outlook = comparison_outlook(contrasts, margin);
  const std::string power = number_text(std::round(100 * outlook.power)) + " %";
  const std::string needed = number_text(outlook.trials_needed_a) + " trials per contrast (" +
                             number_text(std::round(trials_b * share)) + " planned)";
  if (outlook.reaches_80_percent()) {
    return {outlook, "if camera and twin are equal, the comparison finds them equivalent within " + margin_text +
                         " with a probability of " + power + " at best; 80 % would need " + needed};
  }
  return {outlook, "warning: the plan can hardly show equivalence within " + margin_text +
                       ": equal acuities would be found equivalent with a probability of " + power +
                       " at best; 80 % needs " + needed};
}

}  // namespace todbench
