// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/psychometric/acuity.h"

#include <cmath>

namespace todbench {

namespace {

std::optional<double> reciprocal(const std::optional<double>& size_mrad) {
  if (!size_mrad || !std::isfinite(*size_mrad) || *size_mrad <= 0) return std::nullopt;
  return 1 / *size_mrad;
}

}  // namespace

std::optional<double> acuity_per_mrad(const PsychometricFit& fit) {
  return reciprocal(fit.threshold);
}

std::optional<double> stated_threshold(const PsychometricFit& fit) {
  const bool needs_both_ends = fit.verdict == FitVerdict::step || fit.verdict == FitVerdict::extrapolated ||
                               fit.verdict == FitVerdict::underdetermined;
  return !needs_both_ends || (fit.ci95.low && fit.ci95.high) ? fit.threshold : std::nullopt;
}

void remove_threshold(PsychometricFit& fit) {
  fit.threshold.reset();
  fit.ci95 = fit.ci90 = {};
  fit.posterior.reset();
}

std::optional<double> stated_acuity_per_mrad(const PsychometricFit& fit) {
  return reciprocal(stated_threshold(fit));
}

Interval acuity_interval(const Interval& s75_mrad) {
  return {reciprocal(s75_mrad.high), reciprocal(s75_mrad.low)};
}

std::optional<Interval> acuity_spread_per_mrad(const std::optional<std::pair<double, double>>& s75_spread_mrad) {
  if (!s75_spread_mrad) return std::nullopt;
  return acuity_interval({s75_spread_mrad->first, s75_spread_mrad->second});
}

}  // namespace todbench
