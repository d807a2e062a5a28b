// SPDX-License-Identifier: GPL-3.0-or-later
// Acuity from size: the reciprocal, with exchanged bounds.
#pragma once

#include <optional>
#include <utility>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Returns the acuity in 1/mrad: 1 / threshold in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// Returns the threshold if the answers determine it. Empty if the interval has an open end and the verdict is step,
/// extrapolated or underdetermined: the likelihood is then nearly constant on that side, so the position of its maximum
/// is arbitrary.
[[nodiscard]] std::optional<double> stated_threshold(const PsychometricFit& fit);
/// Removes threshold, intervals and posterior of a fit. If the answers do not improve with size, these values only
/// state where the search or the prior ends.
void remove_threshold(PsychometricFit& fit);
/// Returns the acuity in 1/mrad: 1 / stated_threshold() in mrad; empty without a positive threshold.
[[nodiscard]] std::optional<double> stated_acuity_per_mrad(const PsychometricFit& fit);
/// Returns the interval of 1 / S75 with exchanged sides. A lower limit of 0 yields an open side.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);
/// Returns the ends of 1 / S75, in 1/mrad, for a spread of S75 over the open parameters of an observer with an eye;
/// empty without a spread. This is not a confidence interval.
[[nodiscard]] std::optional<Interval> acuity_spread_per_mrad(
    const std::optional<std::pair<double, double>>& s75_spread_mrad);

}  // namespace todbench
