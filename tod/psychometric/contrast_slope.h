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
  double shared_k = 0;  ///< part of it due to errors common to one place, which the scatter over set-ups does not
                        ///< contain
  double degrees_of_freedom = 1;
  double noise_k = 0;  ///< standard error due to the noise of the pixels alone; 0: not known
};

/// Returns the error of a contrast that reports state and schedules use. It is the given error or the error due to the
/// noise of the pixels, whichever has the longer 95 % interval, because the scatter over a few set-ups may be small by
/// chance.
[[nodiscard]] ContrastError at_least_the_noise(ContrastError error);

/// Sets the standard errors of the contrasts in the points of a curve, by set contrast. A point without an entry keeps
/// its own error.
void set_contrast_errors(TodCurve& curve, const std::map<double, ContrastError>& errors);

/// Returns the magnitude of the effective contrast, or of the set contrast if the effective one is not known.
[[nodiscard]] double contrast_seen_k(const TodPoint& point);

/// Returns the standard error of the effective contrast; empty if it was measured once and its scatter is not known.
[[nodiscard]] std::optional<double> contrast_se_k(const TodPoint& point);
/// Returns whether the curve has a contrast of unknown scatter.
[[nodiscard]] bool has_contrast_measured_once(const TodCurve& curve);

/// Returns the degrees of freedom of TodPoint::delta_t_se_k; empty if not stated.
[[nodiscard]] std::optional<double> freedom_of_contrast(const TodPoint& point);

/// Returns for each point the magnitude of the slope of ln acuity as a function of ln |effective contrast|. The slope
/// comes from S75^2 = A + B / C + D / C^2 through the point and its neighbours of the same sign (C: contrast; A:
/// resolution; B, D: noise). With two points it is the larger of the slopes of A + B / C and A + D / C^2. If no
/// neighbour has a threshold, the slope is 1: acuity proportional to the contrast.
[[nodiscard]] std::vector<double> contrast_slopes(const TodCurve& curve);

/// Smallest value of d ln S75 / d ln contrast, from measurements.
inline constexpr double measured_contrast_slope = 1.14;

/// Returns for each point the change of ln S75 with ln contrast: contrast_slopes(), but at least
/// measured_contrast_slope.
[[nodiscard]] std::vector<double> contrast_effects(const TodCurve& curve);

/// Uncertainty of the acuity from the scatter of the measurements of a contrast.
struct ContrastScatter {
  double se_ln_acuity = 0;                     ///< 0 if the scatter is not known
  double shared_se_ln_acuity = 0;              ///< part of it that the scatter over set-ups does not contain
  std::optional<double> degrees_of_freedom{};  ///< empty: not stated
};
/// Returns for each point the standard error of the contrast times contrast_effects().
[[nodiscard]] std::vector<ContrastScatter> contrast_scatter(const TodCurve& curve);

/// Adds a standard uncertainty `u` of ln threshold, which the answers do not contain, to the intervals of a fit, using
/// Student's t with these degrees of freedom.
void join_uncertainty(PsychometricFit& fit, double u, std::optional<double> degrees_of_freedom);

/// Adds the scatter of the effective contrast as an uncertainty of S75. The answers were scored with the effective
/// contrast, and the size is stated at that contrast. Let w be the share of the observer's own noise, and d ln S75 / d
/// ln SNR = -k. A relative error of the contrast changes ln S75 by k w through the score, and by k (1 - w) through the
/// stated contrast, which is k in total for every w. k is 1.14 according to measurements, or the slope of the curve if
/// that is larger.
void join_contrast_errors(TodCurve& curve);

}  // namespace todbench
