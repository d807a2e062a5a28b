// SPDX-License-Identifier: GPL-3.0-or-later
// Collects all findings about a threshold and decides whether the threshold is fit for a decision.
#pragma once

#include <span>

#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Asymptotic probabilities of a false alarm if the model is correct. In a simulation study, the probability of each
/// kind was below 0.01 in every design (docs/method/uncertainty.md).
inline constexpr FalseAlarms false_alarms{.departure = 0.003, .lapse = 0.005, .scatter = 0.003};
/// A significant departure from the model makes a threshold unfit if two limits are exceeded. First limit: the relative
/// change of the threshold by the best alternative description of the answers.
inline constexpr double immaterial_shift = 0.02;
/// Second limit: the same change, as a share of the half-width of the 95 % interval. 0.5 is about one standard error;
/// an interval with such a bias has a coverage of 83 %.
inline constexpr double immaterial_share_of_half_width = 0.5;
/// Scatter makes a threshold unfit if two limits are exceeded. First limit: the variance of the scatter divided by the
/// variance expected by chance.
inline constexpr double immaterial_dispersion = 1.5;
/// Second limit: the widening of the interval on each side due to the scatter, as a share of the threshold.
inline constexpr double immaterial_widening = 0.01;
/// Permitted relative difference between the fit and an exact direct estimate. 1 % is for the difference between the
/// fitted form and the function of the observer, and 1 % is for the error of the direct estimate.
inline constexpr double direct_estimate_tolerance = 0.02;
/// Standard deviation of the noise, in counts, below which the rounding error is not white noise.
inline constexpr double least_noise_counts = 0.5;
/// Correlation of successive frames above which trials are not independent.
inline constexpr double most_lag1_correlation = 0.1;

/// Returns the findings against the threshold of a point that was fitted with `options`. `point`: answers, fit and
/// free_lapse_fit as returned by tod_curve(); a missing free_lapse_fit is computed if it is needed. A pure function. If
/// the verdict of the fit states that there is no threshold, only findings about the answers themselves are returned.
[[nodiscard]] Adequacy adequacy(const TodPoint& point, const FitOptions& options);
/// Returns the findings against the threshold of one fit.
[[nodiscard]] Adequacy adequacy(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options);

/// Examines every point of a curve again and replaces its findings.
void examine(TodCurve& curve, const FitOptions& options);

}  // namespace todbench
