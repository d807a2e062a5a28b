// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted variance of graded answers relative to binary answers.
#pragma once

#include <array>

namespace todbench {

/// Figures of a design with graded answers.
struct GradedDesignFigures {
  /// Share of the sensor in the variance of the noise that decides an answer; the rest is the observer's.
  double sensor_share = 0;
  double pattern_share = 0;  ///< share of the sensor's fixed pattern in the same variance, part of sensor_share
  double noise = 0;          ///< noise that decides an answer at the threshold, divided by the contrast
  double size_pitch = 4;     ///< size of the triangle at the threshold, in pitches
  int frames = 1;            ///< frames per presentation
  int draws = 32;            ///< draws of the observer's noise, per frame
  int set_ups = 8;           ///< plates times mountings
  /// Effective number of set-ups, from their shares of the information: (sum)^2 / sum of squares; 0: equal shares. It
  /// determines whether set-ups are the clusters of the interval (clustered_variance.h).
  double informative_set_ups = 0;
  int presentations = 96;  ///< presentations per contrast
  /// Effective number of presentations, from their shares of the information; 0: equal shares.
  double informative_presentations = 0;
  /// Effective number of places (picture_places.h), from their shares of the information. For binary answers, every
  /// triangle of a set-up is a place. 0: the places do not limit the degrees of freedom.
  double informative_places = 0;
  double noise_correlation = 0;  ///< lag-1 correlation of the sensor's temporal noise, 0 to 1
  double frames_between = 0;     ///< frames between two presentations
};

/// Returns the variance of graded answers divided by the variance of binary answers. It contains the noise of the
/// sensor averaged over frames, the noise of the observer averaged over draws, and set-up terms of phases, contrast and
/// registration:
///
///   (f - g) / F + (1 - f) / (F D) + r + g max(1, n s),
///   f = (3/4)^2 (Phi2(z, z; share) - (2/3)^2) / (p (1 - p)),   p = 3/4 = 1/4 + 3/4 Phi(z)
///
/// F is the number of frames per presentation, D the number of draws per frame, and n the number of phases of a
/// triangle of size S (in pitches).
///
/// f is the share of the sensor's noise in an answer at the threshold (share = sensor_share). The answer is correct by
/// chance in a quarter of the cases; otherwise a Gaussian decision variable (distribution Phi) determines the answer.
/// Phi2 is the probability that this variable makes two answers to the same frame correct.
///
/// g is f with share = pattern_share: the fixed pattern, which averaging over frames does not reduce. The phases reduce
/// the pattern only if they move the triangle across its detectors: s = 1.5 exp(-(1.9 / S)^2). The factor 1.5 applies
/// to set-ups that place triangles on the same detectors (both numbers from 78 runs of `graded_coverage_study` with a
/// pattern of 0.1 K).
///
/// r is 0.048 divided by the number of phases, at most 0.15, if the mountings cancel the phases (five set-ups or more;
/// 138 runs with 12 phases and 11 runs with 3 phases of `graded_coverage_study`). With fewer set-ups the phases do not
/// cancel, and r is 0.28 / (1 + (noise / 0.13)^2), because noise hides the position of a triangle between the detectors
/// (48 runs of adaptive plans at 8 contrasts with the SC2000, 2 to 5 set-ups).
///
/// For first-order noise of lag-1 correlation rho, the answers to two frames at a distance of k frames have in common
/// the share
///   c(k) = (3/4)^2 (Phi2(z, z; pattern share + (sensor share - pattern share) rho^k) - (2/3)^2) / (p (1 - p)) - g.
/// Then (f - g) / F becomes the variance of a mean of F of these answers, and the covariances of successive
/// presentations of a set-up are added, times exp(-(1.9 / S)^2).
[[nodiscard]] double graded_variance_ratio(const GradedDesignFigures& design);

/// Returns the factor by which a fixed pattern and noise correlated in time increase the variance of binary answers:
/// 1 + g (max(1, n s) - 1), plus the covariances of successive presentations (symbols of graded_variance_ratio()).
[[nodiscard]] double pattern_inflation(const GradedDesignFigures& design);

/// Returns the variance of the ln ratio of camera and twin if both are measured at common phases, divided by the
/// variance of the same number of binary answers. The effects of the phases cancel. The remaining terms are the noise
/// of the camera's frames with its fixed pattern, the observer's noise, and the noise of the twin's answers. Each
/// answer of the twin is the mean over `twin_draws` independent frames of the twin. The variance does not contain the
/// scatter of the effective contrast.
[[nodiscard]] double paired_variance_ratio(const GradedDesignFigures& design, int twin_draws);

/// Choices for the number of frames per presentation.
inline constexpr std::array frame_choices{1, 2, 4, 8};

/// Returns the smallest of `frame_choices` whose variance times the time of a presentation is within 10 % of the
/// minimum. `single_s`: time of a presentation of one frame. `frame_s`: time of each further frame. The product is flat
/// around its minimum, so a smaller number of frames increases the time only slightly.
[[nodiscard]] int cheapest_frames(GradedDesignFigures design, double single_s, double frame_s);

/// Returns the half-width of a 95 % interval of ln S75 divided by the standard error: Student's t times
/// graded_likely_excess(). The second factor covers 95 % of runs, because a variance from few set-ups scatters as
/// chi-square over its degrees of freedom. With five set-ups or more, the result includes the factor 1.06 for the
/// detectors that set-ups have in common by chance (clustered_variance.h).
[[nodiscard]] double graded_interval_factor(const GradedDesignFigures& design);
/// Returns the ratio of estimated to true standard error that 19 of 20 estimates with these degrees of freedom do not
/// exceed.
[[nodiscard]] double likely_excess_of_error(double degrees_of_freedom);
/// Returns the second factor of graded_interval_factor(): likely_excess_of_error() with graded_freedom() if set-ups are
/// the clusters. Otherwise the degrees of freedom are 0.7 times the number of presentations minus 0.5, at least 3.
[[nodiscard]] double graded_likely_excess(const GradedDesignFigures& design);
/// Returns whether set-ups are the clusters of the interval of graded answers, as in clustered_variance().
[[nodiscard]] bool set_ups_are_clusters(const GradedDesignFigures& design);
/// Returns the degrees of freedom of a variance over presentations and places, as clustered_variance() computes them:
/// the smaller of their effective numbers minus one, at least 1.
[[nodiscard]] double two_way_freedom(const GradedDesignFigures& design);
/// Returns the degrees of freedom of the variance of graded answers: the number of set-ups minus one if set-ups are the
/// clusters, otherwise two_way_freedom().
[[nodiscard]] double graded_freedom(const GradedDesignFigures& design);

}  // namespace todbench
