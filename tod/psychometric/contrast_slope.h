// SPDX-License-Identifier: GPL-3.0-or-later
// Effect of an error of the contrast on the acuity.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Standard error of a measured contrast.
struct ContrastError {
  double standard_error_k = 0;
  /// Part of standard_error_k due to errors common to one position. The scatter over set-ups does not contain this
  /// part.
  double shared_k = 0;
  double degrees_of_freedom = 1;
  double noise_k = 0;  ///< standard error due to the noise of the pixels alone; 0: not known
};

/// Returns the error of a contrast for reports and schedules: the given error, or the error due to pixel noise alone if
/// the interval of the noise error is wider. The reason is that, with few set-ups, the scatter may be small by chance.
/// Pixel noise is therefore a lower limit of the error.
[[nodiscard]] ContrastError at_least_the_noise(ContrastError error);

/// Sets the standard errors of the contrasts in the points of a curve, by set contrast. A point without an entry is not
/// changed.
void set_contrast_errors(TodCurve& curve, const std::map<double, ContrastError>& errors);

/// Returns the magnitude of the effective contrast, or of the set contrast if the effective contrast is not known.
[[nodiscard]] double contrast_seen_k(const TodPoint& point);

/// Returns the standard error of the effective contrast; empty if the contrast was measured once and the scatter is not
/// known.
[[nodiscard]] std::optional<double> contrast_se_k(const TodPoint& point);
/// Returns whether the scatter of a contrast of the curve is unknown.
[[nodiscard]] bool has_contrast_measured_once(const TodCurve& curve);

/// Returns the degrees of freedom of TodPoint::delta_t_se_k; empty if not stated.
[[nodiscard]] std::optional<double> freedom_of_contrast(const TodPoint& point);

/// Returns for each point the magnitude of the slope of ln acuity as a function of ln |effective contrast|. The slope
/// is that of S75^2 = A + B / C + D / C^2 through the point and its neighbours of the same sign (C: contrast; A:
/// resolution; B, D: noise). With two points, the slope is the larger of the slopes of A + B / C and A + D / C^2. If no
/// neighbour has a threshold, the slope is 1, as for an acuity proportional to the contrast.
[[nodiscard]] std::vector<double> contrast_slopes(const TodCurve& curve);

/// Smallest magnitude of d ln S75 / d ln contrast that contrast_effects() assumes. The value was determined in
/// simulated sessions (docs/validation/coverage.md).
inline constexpr double measured_contrast_slope = 1.14;

/// Returns for each point the change of ln S75 with ln contrast: contrast_slopes(), but at least
/// measured_contrast_slope.
[[nodiscard]] std::vector<double> contrast_effects(const TodCurve& curve);

/// Uncertainty of the acuity from the scatter of the measurements of a contrast.
struct ContrastScatter {
  double se_ln_acuity = 0;                     ///< 0 if the scatter is not known
  double shared_se_ln_acuity = 0;              ///< part of se_ln_acuity that the scatter over set-ups does not contain
  std::optional<double> degrees_of_freedom{};  ///< empty: not stated
};
/// Returns for each point the standard error of the contrast times contrast_effects().
[[nodiscard]] std::vector<ContrastScatter> contrast_scatter(const TodCurve& curve);

/// Widens the intervals of a fit by a standard uncertainty `u` of ln threshold that is not due to the answers. Uses
/// Student's t with `degrees_of_freedom`.
void join_uncertainty(PsychometricFit& fit, double u, std::optional<double> degrees_of_freedom);

/// Adds the scatter of the effective contrast as an uncertainty of S75. The effective contrast has two uses: the scores
/// are computed with it, and S75 is stated at it. Let w be the share of the internal noise of the observer, and d ln
/// S75 / d ln SNR = -k. A relative error of the contrast changes ln S75 by k w because of the scores, and by k (1 - w)
/// because of the stated contrast. The sum is k for every w. The value of k is 1.14, as measured, or the slope of the
/// curve if the slope is larger.
void join_contrast_errors(TodCurve& curve);

}  // namespace todbench
