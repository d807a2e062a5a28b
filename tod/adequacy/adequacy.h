// SPDX-License-Identifier: GPL-3.0-or-later
// Collects all findings about a threshold and decides whether the threshold is fit for a decision.
#pragma once

#include <span>

#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Asymptotic probabilities of a false alarm if the model is correct. In a simulation study each kind stays below 0.01
/// in every design (docs/method/uncertainty.md).
inline constexpr FalseAlarms false_alarms{.departure = 0.003, .lapse = 0.005, .scatter = 0.003};
/// A significant departure from the model makes a threshold unfit if the best alternative description of the answers
/// changes it by more than this share ...
inline constexpr double immaterial_shift = 0.02;
/// ... and by more than this share of half the 95 % interval (one standard error; with a bias of that size an interval
/// has 83 % coverage).
inline constexpr double immaterial_share_of_half_width = 0.5;
/// Scatter makes a threshold unfit if its variance exceeds the chance variance by more than this factor ...
inline constexpr double immaterial_dispersion = 1.5;
/// ... and if allowing for the scatter widens the interval on each side by more than this share of the threshold.
inline constexpr double immaterial_widening = 0.01;
/// Permitted relative difference between the fit and an exact direct estimate: 1 % because the fitted form differs from
/// the function of the observer, and 1 % for the error of the direct estimate.
inline constexpr double direct_estimate_tolerance = 0.02;
/// Standard deviation of the noise, in counts, below which the rounding error is not white noise.
inline constexpr double least_noise_counts = 0.5;
/// Correlation of successive frames above which trials are not independent.
inline constexpr double most_lag1_correlation = 0.1;

/// Returns the findings against the threshold of a point that was fitted with `options`. Expects answers, fit and
/// free_lapse_fit as tod_curve() returns them, and computes free_lapse_fit if it is missing and needed. A pure
/// function. If the fit has no threshold (its verdict states this), only findings about the answers themselves are
/// returned.
[[nodiscard]] Adequacy adequacy(const TodPoint& point, const FitOptions& options);
/// Same for one fit.
[[nodiscard]] Adequacy adequacy(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options);

/// Examines every point of a curve again and replaces its findings.
void examine(TodCurve& curve, const FitOptions& options);

}  // namespace todbench
