// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/forecast/comparison_forecast.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"
#include "bench/plan/plan_options.h"
#include "bench/text/text.h"

namespace todbench {
namespace {

/// Standard error of ln S75 from the interval; empty if a side is open.
std::optional<double> standard_error(const PsychometricFit& fit) {
  if (!fit.ci95.low || !fit.ci95.high || !(*fit.ci95.low > 0)) return std::nullopt;
  return std::log(*fit.ci95.high / *fit.ci95.low) / (2 * normal_z95);
}

/// From here on a probability would round to 100 %, which is never correct.
constexpr double nearly_certain = 0.995;

/// "62 %"; "more than 99 %" instead of a rounded 100 %.
std::string probability_text(double probability) {
  return probability >= nearly_certain ? "more than 99 %" : number_text(std::round(100 * probability)) + " %";
}

}  // namespace

ComparisonForecast comparison_forecast(const Plan& plan, const PlanPrediction& prediction) {
  const double margin = comparison_options(plan).margin_percent;
  const std::string margin_text = number_text(margin) + " %";
  // Ratio of the camera's trials to the twin's; an adaptive schedule is the same for both, and a ramp has no phases.
  const double share = plan.schedule.kind == ScheduleKind::constant
                           ? static_cast<double>(plan.target.phases) / plan.simulation.phases
                           : 1.0;
  double planned = 0;
  std::vector<PlannedComparison> contrasts;
  for (const ContrastPrediction& contrast : prediction.contrasts) {
    if (!contrast.uncertainty_percent || !(*contrast.uncertainty_percent > 0)) {
      return {std::nullopt, "the comparison with the twin cannot be decided at " + number_text(contrast.delta_t_k) +
                                " K: the expected threshold is outside the sizes of the plates"};
    }
    const double unpaired = std::log1p(*contrast.uncertainty_percent / 100) / normal_z95;
    // The twin sees the presentations of the camera: the whole ratio depends on their number.
    const double half_of_pair = contrast.paired_se_ln_ratio.value_or(0) / std::sqrt(2 * share);
    const bool paired = contrast.paired_se_ln_ratio.has_value();
    contrasts.push_back({.delta_t_k = contrast.delta_t_k,
                         .se_ln_a = paired ? half_of_pair : unpaired / std::sqrt(share),
                         .se_ln_b = paired ? half_of_pair : unpaired,
                         .trials_a = contrast.trials * share,
                         .trials_b = contrast.trials});
    planned = std::max(planned, contrast.trials * share);
  }
  if (contrasts.empty()) return {};
  const ComparisonOutlook outlook = comparison_outlook(contrasts, margin);
  const std::string power = probability_text(outlook.power);
  const std::string needed =
      number_text(outlook.trials_needed_a) + " trials per contrast (" + number_text(std::round(planned)) + " planned)";
  if (outlook.reaches_80_percent()) {
    return {outlook, "if camera and twin are equal, the comparison declares them equivalent within " + margin_text +
                         " with a probability of " + (outlook.power >= nearly_certain ? "" : "at least ") + power +
                         ". A probability of 80 % would need " + needed};
  }
  return {outlook, "warning: the plan is unlikely to show equivalence within " + margin_text +
                       ": equal acuities would be declared equivalent with a probability of " + power +
                       ". A probability of 80 % needs " + needed};
}

ComparisonForecast comparison_forecast(const TodCurve& a, const TodCurve& b, const Comparison& comparison) {
  std::vector<PlannedComparison> contrasts;
  double margin = 0, trials = 0;
  for (const ComparisonPoint& point : comparison.points) {
    const TodPoint* of_a = point_at(a, point.set_delta_t_k);
    const TodPoint* of_b = point_at(b, point.set_delta_t_k);
    if (of_a == nullptr || of_b == nullptr) continue;
    const auto se_a = standard_error(of_a->fit), se_b = standard_error(of_b->fit);
    if (!se_a || !se_b) {
      return {std::nullopt, "warning: these trials cannot show equivalence at " + number_text(point.set_delta_t_k) +
                                " K: an interval has no upper or no lower limit"};
    }
    margin = point.margin_percent;
    trials = std::max(trials, of_a->fit.trials);
    contrasts.push_back({.delta_t_k = point.set_delta_t_k,
                         .se_ln_a = *se_a,
                         .se_ln_b = *se_b,
                         .trials_a = of_a->fit.trials,
                         .trials_b = of_b->fit.trials});
  }
  if (contrasts.empty()) return {};
  const ComparisonOutlook outlook = comparison_outlook(contrasts, margin);
  const std::string sentence = "with this number of trials, equal acuities are declared equivalent within " +
                               number_text(margin) + " % with a probability of " + probability_text(outlook.power) +
                               ". A probability of 80 % needs " + number_text(outlook.trials_needed_a) +
                               " trials per contrast of A (" + number_text(trials) +
                               " made), and the same proportion of B";
  return {outlook, (outlook.reaches_80_percent() ? "" : "warning: ") + sentence};
}

}  // namespace todbench
