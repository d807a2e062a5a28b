// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/comparison/planning.h"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cassert>
#include <cmath>
#include <string>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

const distribution::Normal standard_normal;

double normal_cdf(double z) {
  return distribution::cdf(standard_normal, z);
}
double normal_quantile(double p) {
  return distribution::quantile(standard_normal, p);
}

constexpr double one_sided_level = 0.05;

double power_of(std::span<const PlannedComparison> contrasts, double margin_percent, double factor) {
  double power = 1;
  for (const PlannedComparison& contrast : contrasts)
    power *= equivalence_power(contrast.se_ln_ratio() / std::sqrt(factor), margin_percent, 0);
  return power;
}

}  // namespace

Result<ExpectedFit> expected_fit(std::span<const PlannedLevel> design, const FitOptions& options) {
  // Counts have to be whole: with a million times as many trials, rounding is 1e-6 of a trial.
  constexpr double many = 1e6;
  std::vector<Level> levels;
  double trials = 0;
  for (const PlannedLevel& level : design) {
    const bool possible = level.size > 0 && std::isfinite(level.size) && level.trials >= 0 &&
                          std::isfinite(level.trials) && level.proportion_correct >= 0 && level.proportion_correct <= 1;
    if (!possible)
      return fail(ErrorCode::invalid_input,
                  "a planned level has a size, a number of trials or a proportion outside its range");
    const double total = std::round(level.trials * many);
    levels.push_back({level.size, std::min(std::round(level.trials * level.proportion_correct * many), total), total});
    trials += level.trials;
  }
  FitOptions plain = options;
  plain.with_posterior = false;
  TODBENCH_TRY(auto fit, fit_psychometric(levels, plain));
  if (!fit.threshold || !fit.se_ln_threshold || !(*fit.se_ln_threshold > 0) ||
      fit.verdict == FitVerdict::flat_or_decreasing || fit.verdict == FitVerdict::underdetermined) {
    return fail(ErrorCode::invalid_input,
                "no threshold can be expected from these sizes (" + std::string(to_string(fit.verdict)) + ")");
  }
  return ExpectedFit{*fit.threshold, fit.slope.value_or(max_slope), trials, *fit.se_ln_threshold * std::sqrt(many)};
}

std::vector<PlannedLevel> design_at(std::span<const Level> totals, PsychometricForm form, double threshold,
                                    double slope, double lapse) {
  std::vector<PlannedLevel> design;
  for (const Level& level : totals)
    design.push_back({level.size, level.total, psychometric(form, level.size, threshold, slope, lapse)});
  return design;
}

double equivalence_power(double se_ln_ratio, double margin_percent, double true_ln_ratio) {
  assert(se_ln_ratio > 0 && margin_percent > 0);
  const double margin = std::log1p(margin_percent / 100);
  const double z = normal_quantile(1 - one_sided_level);
  const double upper = (margin - true_ln_ratio) / se_ln_ratio - z;
  const double lower = (-margin - true_ln_ratio) / se_ln_ratio + z;
  return upper > lower ? normal_cdf(upper) - normal_cdf(lower) : 0;
}

double PlannedComparison::se_ln_ratio() const {
  return std::hypot(se_ln_a, se_ln_b);
}

ComparisonOutlook comparison_outlook(std::span<const PlannedComparison> contrasts, double margin_percent) {
  assert(!contrasts.empty());
  constexpr double wanted = 0.8;
  ComparisonOutlook outlook;
  outlook.margin_percent = margin_percent;
  outlook.power = power_of(contrasts, margin_percent, 1);
  // Power grows with the factor from 0 to 1: bracket, then refine.
  double low = 1, high = 1;
  while (power_of(contrasts, margin_percent, high) < wanted) high *= 2;
  while (power_of(contrasts, margin_percent, low) >= wanted) low /= 2;
  std::uintmax_t rounds = 100;
  const auto missing = [&](double factor) { return power_of(contrasts, margin_percent, factor) - wanted; };
  outlook.trials_factor =
      boost::math::tools::toms748_solve(missing, low, high, boost::math::tools::eps_tolerance<double>(30), rounds)
          .second;
  for (const PlannedComparison& contrast : contrasts)
    outlook.trials_needed_a = std::max(outlook.trials_needed_a, std::ceil(contrast.trials_a * outlook.trials_factor));
  return outlook;
}

}  // namespace todbench
