// SPDX-License-Identifier: GPL-3.0-or-later
// Acuity from size: the reciprocal, with exchanged bounds.
#pragma once

#include <optional>
#include <utility>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Acuity in 1/mrad: 1 / threshold in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// The threshold, if the answers determine it. Empty for the verdicts step, extrapolated and underdetermined if an end
/// of the interval is open: the likelihood is nearly constant on that side, and the search ended somewhere on it.
[[nodiscard]] std::optional<double> stated_threshold(const PsychometricFit& fit);
/// Takes threshold, intervals and posterior from a fit whose answers do not increase with size: they are places far
/// from the sizes, where the search or the prior ends.
void remove_threshold(PsychometricFit& fit);
/// The reciprocal of stated_threshold() in mrad, in 1/mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> stated_acuity_per_mrad(const PsychometricFit& fit);
/// The interval of 1 / S75 with exchanged sides. A lower limit of 0 gives an open side.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);
/// The ends of 1 / S75, in 1/mrad, for a spread of S75 over the open parameters of an observer with an eye; empty
/// without one. No confidence interval.
[[nodiscard]] std::optional<Interval> acuity_spread_per_mrad(
    const std::optional<std::pair<double, double>>& s75_spread_mrad);

}  // namespace todbench
