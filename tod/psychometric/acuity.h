// SPDX-License-Identifier: GPL-3.0-or-later
// Converts S75, the size at 75 % correct answers, to acuity = 1 / S75. Lower and upper limits are exchanged.
#pragma once

#include <optional>
#include <utility>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Returns the acuity in 1/mrad: 1 / threshold in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// Returns the threshold if the answers determine it. Empty if a side of the interval is open and the verdict is step,
/// extrapolated or underdetermined. In this case the likelihood is nearly constant on the open side, so the position of
/// its maximum is arbitrary.
[[nodiscard]] std::optional<double> stated_threshold(const PsychometricFit& fit);
/// Removes threshold, intervals and posterior of a fit. Use it if the share of correct answers does not increase with
/// size, because these values then only show the limits of the search or of the prior.
void remove_threshold(PsychometricFit& fit);
/// Returns the acuity in 1/mrad: 1 / stated_threshold() in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> stated_acuity_per_mrad(const PsychometricFit& fit);
/// Returns the interval of 1 / S75, with lower and upper limit exchanged. If the lower limit of S75 is 0, the upper
/// side is open.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);
/// Returns the lowest and the highest 1 / S75, in 1/mrad, for a spread of S75 over the open parameters of an observer
/// with an eye. Empty without a spread. This is not a confidence interval.
[[nodiscard]] std::optional<Interval> acuity_spread_per_mrad(
    const std::optional<std::pair<double, double>>& s75_spread_mrad);

}  // namespace todbench
