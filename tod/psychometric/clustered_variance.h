// SPDX-License-Identifier: GPL-3.0-or-later
// Variance of an estimate from answers that share a set-up, a presentation and a place on the plate.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Maximum number of parameters of an estimating equation.
inline constexpr std::size_t most_parameters = 4;

/// Minimum number of set-ups for their variance to be used. With four set-ups, and therefore three degrees of
/// freedom, Student's t would be 3.2.
inline constexpr double least_set_ups = 5;

/// Contribution of one answer to the estimating equation of a quasi-likelihood, in standard deviations of the variance
/// function v(mu).
struct AnswerScore {
  std::array<double, most_parameters> direction{};  ///< (d mu / d parameter) / sqrt(v)
  double residual = 0;                              ///< (answer - mu) / sqrt(v)
  int presentation = 0;                             ///< index, at least 0
  int place = 0;                                    ///< index of the place in the picture (picture_places.h)
  int set_up = 0;                                   ///< index of plate and mounting; each presentation has one
};

/// Source of the scatter of single answers.
enum class AnswerScatter {
  estimated,  ///< graded answers: estimated from their residuals
  binomial,   ///< correct and wrong answers: from chance
};

/// The variance of one parameter over clusters.
struct ClusteredVariance {
  IntervalKind kind = IntervalKind::two_way;  ///< set_ups or two_way
  double variance = 0;
  double independent = 0;         ///< variance of independent binomial answers: the inverse information
  double degrees_of_freedom = 1;  ///< degrees of freedom of the variance, at least 1
  double dispersion = 1;  ///< sum of squared residuals divided by (answers minus parameters): 1 for binomial answers
};

/// Returns the variance of parameter `which` of `parameters` estimated ones. It is the sandwich estimate (Liang and
/// Zeger 1986) with the leverage correction CR2 of the clusters (Bell and McCaffrey 2002). It may be below the binomial
/// variance if answers scatter less.
///
/// Graded answers: the phases of one set-up are evenly spaced from one start, and its contrast and registration are
/// measured once. Set-ups therefore contain the variation common to presentations. Even spacing makes the scatter over
/// set-ups much smaller than the scatter over single answers; a hundredth of the latter is the lower limit. With at
/// least `least_set_ups` set-ups, set-ups are the clusters. Set-ups that image triangles onto the same detectors share
/// their fixed pattern. Therefore the covariance of answers of different set-ups at one place in the picture is added:
/// V_place - V_triangle, where a triangle is the part of a place in one set-up (two-way, Cameron, Gelbach and Miller
/// 2011). A negative value is set to zero. With fewer set-ups, presentations and places are two-way clusters,
/// V_presentation + V_place - V_answer, at least the variance of either alone. This is safe, but too large if evenly
/// spread phases cancel.
///
/// Correct and wrong answers: their binomial scatter is far larger than the variation common to a set-up, and a
/// variance over eight set-ups itself scatters by a quarter. For `binomial` answers, presentations and triangles are
/// therefore two-way clusters for any number of set-ups, with at least the binomial variance. If there is only one
/// cluster of a kind, the other kind is used.
///
/// Degrees of freedom: number of clusters minus one. The number of clusters is the effective number, (sum of shares)^2
/// / sum of squared shares of the information (Satterthwaite 1946). For two-way clusters, the smaller number applies.
///
/// The variance is infinite if the information is singular, or if there are fewer than two clusters of a required kind.
[[nodiscard]] ClusteredVariance clustered_variance(std::span<const AnswerScore> answers, std::size_t parameters,
                                                   std::size_t which, AnswerScatter scatter = AnswerScatter::estimated);

}  // namespace todbench
