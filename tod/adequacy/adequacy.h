// SPDX-License-Identifier: GPL-3.0-or-later
// Collects all findings about a threshold and decides whether the threshold is fit for a decision.
#pragma once

#include <span>

#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Asymptotic probabilities of a false alarm if the model is correct. In a simulation study, the probability of a false
/// alarm of each kind was below 0.01 in every design (docs/method/uncertainty.md).
inline constexpr FalseAlarms false_alarms{.departure = 0.003, .lapse = 0.005, .scatter = 0.003};
/// First of two limits for a significant departure from the model: relative change of the threshold if the best
/// alternative function (best_alternative()) is fitted instead. If both limits are exceeded, the threshold is unfit.
inline constexpr double immaterial_shift = 0.02;
/// Second limit for a departure: the same change, divided by the half-width of the 95 % interval. The value 0.5 is
/// about one standard error. An interval with this bias contains the true threshold with a probability of 83 %.
inline constexpr double immaterial_share_of_half_width = 0.5;
/// First of two limits for scatter: variance of the scatter divided by the variance expected by chance. If both limits
/// are exceeded, the threshold is unfit.
inline constexpr double immaterial_dispersion = 1.5;
/// Second limit for scatter: the amount by which scatter widens the interval on each side, divided by the threshold.
inline constexpr double immaterial_widening = 0.01;
/// Permitted relative difference between the fit and an exact direct estimate. The value is the sum of 1 % for the
/// difference between the fitted form and the observer's function, and 1 % for the error of the direct estimate.
inline constexpr double direct_estimate_tolerance = 0.02;
/// Standard deviation of the noise, in counts, below which the rounding error is not white noise.
inline constexpr double least_noise_counts = 0.5;
/// Correlation of successive frames above which trials are not independent.
inline constexpr double most_lag1_correlation = 0.1;

/// Returns the findings against the threshold of a point that was fitted with `options`. `point`: answers, fit and
/// free_lapse_fit as returned by tod_curve(); a missing free_lapse_fit is computed if it is needed. If the verdict of
/// the fit states that there is no threshold, only findings about the answers are returned. A pure function.
[[nodiscard]] Adequacy adequacy(const TodPoint& point, const FitOptions& options);
/// Returns the findings against the threshold of one fit.
[[nodiscard]] Adequacy adequacy(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options);

/// Examines every point of a curve again and replaces its findings.
void examine(TodCurve& curve, const FitOptions& options);

}  // namespace todbench
