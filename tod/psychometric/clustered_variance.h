// The variance of an estimate from answers that have a set-up, a presentation and a place on the plate in common.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Parameters of an estimating equation, at most.
inline constexpr std::size_t most_parameters = 4;

/// With fewer set-ups their variance says too little: Student's t with three degrees of freedom is 3.2.
inline constexpr double least_set_ups = 5;

/// One answer in a quasi-likelihood: what it adds to the estimating equation, in standard deviations of the variance
/// function v(mu).
struct AnswerScore {
  std::array<double, most_parameters> direction{};  ///< d mu / d parameter over sqrt(v)
  double residual = 0;                              ///< (answer - mu) / sqrt(v)
  int presentation = 0;                             ///< whole numbers of 0 or more
  int place = 0;                                    ///< in the picture (picture_places.h)
  int set_up = 0;                                   ///< of the plate and its mounting: a presentation has one
};

/// What is known of the scatter of single answers.
enum class AnswerScatter {
  estimated,  ///< graded answers: their own residuals say it
  binomial,   ///< right and wrong ones: chance does
};

/// The variance of one parameter over clusters.
struct ClusteredVariance {
  IntervalKind kind = IntervalKind::two_way;  ///< set_ups or two_way
  double variance = 0;
  double independent = 0;         ///< the same as if the answers were binomial: the inverse information
  double degrees_of_freedom = 1;  ///< of the variance, 1 or more
  double dispersion = 1;          ///< mean squared residual over answers less parameters: 1 for binomial answers
};

/// Of parameter `which` of `parameters` that were estimated: sandwich (Liang and Zeger 1986) with the leverage
/// correction CR2 of the clusters (Bell and McCaffrey 2002). It may be below the binomial variance where answers
/// scatter less.
///
/// Phases of one set-up are spread evenly from one start, and contrast and registration are measured once in it:
/// set-ups hold what presentations have in common, and phases make the scatter over them much smaller than that over
/// single answers. Less than a hundredth of the latter is not believed. From `least_set_ups` on they are the clusters.
/// Set-ups that put triangles before the same detectors share their fixed pattern: what answers of different set-ups
/// have in common at one place in the picture is added, V_place - V_triangle, a triangle being what a set-up has at a
/// place (both ways, Cameron, Gelbach and Miller 2011), and nothing where it is negative. With fewer set-ups,
/// presentations and places are clusters both ways, V_presentation + V_place - V_answer, but not below that of either
/// alone: safe, and too long where evenly spread phases cancel.
///
/// Right and wrong answers scatter by chance far more than by what a set-up has in common, and a variance over eight
/// set-ups scatters by a quarter itself: `binomial` ones have presentations and triangles as clusters both ways,
/// however many set-ups there are, and at least the binomial variance. Where there is one cluster of a kind the other
/// is used.
///
/// Degrees of freedom: clusters less one, with (sum of shares)^2 / sum of squared shares of the information as their
/// number (Satterthwaite 1946); both ways, those of the fewer ones.
///
/// Where the information is singular, or there are fewer than two clusters of a kind that is needed, nothing is known:
/// variance infinite.
[[nodiscard]] ClusteredVariance clustered_variance(std::span<const AnswerScore> answers, std::size_t parameters,
                                                   std::size_t which, AnswerScatter scatter = AnswerScatter::estimated);

}  // namespace todbench
