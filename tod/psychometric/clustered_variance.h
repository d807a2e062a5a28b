// SPDX-License-Identifier: GPL-3.0-or-later
// Variance of an estimate from answers that share a set-up, a presentation or a position in the picture.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Maximum number of parameters of an estimating equation.
inline constexpr std::size_t most_parameters = 4;

/// Minimum number of set-ups for a variance over set-ups. Four set-ups would give three degrees of freedom, for which
/// Student's t is 3.2.
inline constexpr double least_set_ups = 5;

/// Contribution of one answer to the estimating equation of a quasi-likelihood, in units of sqrt(v), where v(mu) is the
/// variance function and mu the mean of the answer.
struct AnswerScore {
  std::array<double, most_parameters> direction{};  ///< (d mu / d parameter) / sqrt(v)
  double residual = 0;                              ///< (answer - mu) / sqrt(v)
  int presentation = 0;                             ///< index, at least 0
  int place = 0;                                    ///< index of the position in the picture (picture_places.h)
  int set_up = 0;  ///< index of the combination of plate and mounting; each presentation has one set-up
};

/// Source of the scatter of single answers.
enum class AnswerScatter {
  estimated,  ///< graded answers: the scatter is estimated from the residuals
  binomial,   ///< binary answers: the scatter is binomial
};

/// The variance of one parameter over clusters.
struct ClusteredVariance {
  IntervalKind kind = IntervalKind::two_way;  ///< set_ups or two_way
  double variance = 0;
  double independent = 0;         ///< variance of independent binomial answers: the inverse information
  double degrees_of_freedom = 1;  ///< degrees of freedom of the variance, at least 1
  double dispersion = 1;  ///< sum of squared residuals divided by (answers minus parameters): 1 for binomial answers
};

/// Returns the variance of the estimated parameter `which`. `parameters`: number of estimated parameters. The variance
/// is the sandwich estimate (Liang and Zeger 1986) with the leverage correction CR2 of the clusters (Bell and McCaffrey
/// 2002). The variance is below the binomial variance if the answers scatter less than binary answers.
///
/// Graded answers: with at least `least_set_ups` set-ups, set-ups are the clusters. The phases of one set-up are evenly
/// spaced from one start, and contrast and registration are measured once per set-up. The scatter over set-ups
/// therefore contains the variation common to presentations. Because of the even spacing, the scatter over set-ups is
/// much smaller than the scatter over single answers. The lower limit of the scatter over set-ups is a hundredth of the
/// scatter over single answers. Set-ups that image triangles onto the same detectors have the same fixed pattern. The
/// covariance of answers of different set-ups at one position in the picture is therefore added: V_place - V_triangle,
/// where V_x is the variance over clusters of kind x (two-way, Cameron, Gelbach and Miller 2011). Here a triangle is
/// the part of a position in one set-up. A negative covariance is set to zero. With fewer set-ups, presentations and
/// positions are two-way clusters: V_presentation + V_place - V_answer, at least V_presentation and at least V_place.
/// This variance is never too small. It is too large if the effects of evenly spread phases cancel.
///
/// Binary answers (`binomial`): for any number of set-ups, presentations and triangles are two-way clusters, and the
/// variance is at least the binomial variance. Set-ups are not used as clusters for two reasons: the binomial scatter
/// is far larger than the variation common to a set-up, and a variance over eight set-ups has a standard deviation of a
/// quarter. If there is only one cluster of a kind, the other kind is used.
///
/// Degrees of freedom: effective number of clusters minus one. The effective number is (sum of shares)^2 / sum of
/// squared shares, with the share of each cluster in the information (Satterthwaite 1946). For two-way clusters, the
/// smaller number is used.
///
/// The variance is infinite if the information is singular, or if a required kind has fewer than two clusters.
[[nodiscard]] ClusteredVariance clustered_variance(std::span<const AnswerScore> answers, std::size_t parameters,
                                                   std::size_t which, AnswerScatter scatter = AnswerScatter::estimated);

}  // namespace todbench
