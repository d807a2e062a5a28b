// One gate for the validity of a threshold: everything that speaks against it, and whether it may decide anything.
#pragma once

#include <span>

#include "tod/adequacy/false_alarms.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Probabilities of a false alarm under the right model, as the laws of large numbers of trials have it. By study each
/// kind stays below 0.01 in every design (docs/uncertainty.md).
inline constexpr FalseAlarms false_alarms{.departure = 0.003, .lapse = 0.005, .scatter = 0.003};
/// A significant departure of the model makes a threshold unfit where the best other description of the answers moves
/// it by more than this share ...
inline constexpr double immaterial_shift = 0.02;
/// ... and by more than this share of half the 95 % interval (one standard error: a bias of that size leaves an
/// interval with 83 % coverage).
inline constexpr double immaterial_share_of_half_width = 0.5;
/// Scatter makes a threshold unfit where its variance is more than this multiple of chance ...
inline constexpr double immaterial_dispersion = 1.5;
/// ... and an interval that allowed for it would be longer on each side by more than this share of the threshold.
inline constexpr double immaterial_widening = 0.01;
/// By how much the fit may differ from an exact direct estimate because the form is not that of the observer, and the
/// direct estimate from the truth (1 % each).
inline constexpr double direct_estimate_tolerance = 0.02;
/// Below this standard deviation in counts rounding is no white noise.
inline constexpr double least_noise_counts = 0.5;
/// Correlation of successive frames beyond which trials are not independent.
inline constexpr double most_lag1_correlation = 0.1;

/// What speaks against the threshold of a point that was fitted by `options`. Answers, fit and free_lapse_fit as
/// tod_curve() leaves them (the latter is made where it is missing and needed). A pure function; the same answers give
/// the same findings. A fit without a threshold has no number that could be unfit: its verdict says so, and only what
/// spoils the answers themselves is found.
[[nodiscard]] Adequacy adequacy(const TodPoint& point, const FitOptions& options);
/// The same of one fit.
[[nodiscard]] Adequacy adequacy(std::span<const Level> levels, const PsychometricFit& fit, const FitOptions& options);

/// Examines every point anew.
void examine(TodCurve& curve, const FitOptions& options);

}  // namespace todbench
