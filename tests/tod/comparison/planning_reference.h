// SPDX-License-Identifier: GPL-3.0-or-later
// Closed forms that planning is held against.
#pragma once

#include <boost/math/distributions/normal.hpp>
#include <cmath>

namespace todbench::test {

/// Least standard error of ln threshold that any placement of `trials` independent 4AFC trials can have with slope and
/// threshold unknown, size form and no lapse: 0.4505 (3.5 / slope) / sqrt(trials), reached with all trials at the
/// threshold, where psi = 3/4 and dpsi/dlnx = (b/4) ln 3 (Elfving 1952; Fisher information of a Bernoulli trial).
inline double least_se_ln_threshold(double trials, double slope) {
  // d psi / d ln x = (1-g) kappa e^-kappa b at the threshold, kappa = ln 3; the information of a trial is its square
  // over psi (1 - psi).
  const double derivative = slope * 0.25 * std::log(3.0);
  return std::sqrt(0.75 * 0.25 / trials) / derivative;
}

/// The largest standard error of a log ratio with which equivalence is found with probability `power` when both are
/// equal in truth: ln(1+m) / (z_0.95 + z_(1+power)/2).
inline double se_for_equivalence(double margin_percent, double power) {
  const boost::math::normal standard;
  return std::log1p(margin_percent / 100) / (quantile(standard, 0.95) + quantile(standard, (1 + power) / 2));
}

}  // namespace todbench::test
