// The figures of a report: the TOD curve and one psychometric function per contrast.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/report/plot.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Answers at one size, presentations put together.
struct AnswersAtSize {
  double size_mrad = 0;
  double correct = 0, total = 0;  ///< of graded answers the sum of their probabilities
  /// Over groups (presentations, or places): how many, and the sums of squares and products of `correct` and `total`.
  double groups = 0, squares = 0, products = 0, total_squares = 0;
  bool graded = false;
};

/// Levels of equal size (to 1e-6) added up, sizes increasing; levels without trials are left out.
[[nodiscard]] std::vector<AnswersAtSize> answers_by_size(const TodPoint& point);

/// Wilson's score interval for a proportion, 95 % (Wilson 1927; Brown, Cai and DasGupta 2001, eq. 4). Both sides open
/// when total is 0.
[[nodiscard]] Interval wilson_interval(double correct, double total);

/// 95 % interval of the proportion at a size: of right and wrong answers Wilson's, every one taken as independent.
/// Graded answers scatter less than chance: theirs is mean -+ t s over presentations, s^2 = K / (K - 1) sum (c - m n)^2
/// / N^2 for a ratio of sums, cut off at 0 and 1; both sides open below two presentations. Where phases of a set-up
/// cancel it is longer than need be.
[[nodiscard]] Interval proportion_interval(const AnswersAtSize& answers);

/// A curve and how the figures name it.
struct NamedCurve {
  std::string name;                 ///< "measured", "simulated"
  const TodCurve* curve = nullptr;  ///< borrowed for the call; null: not there
};

/// The least acuity that a limit asks for at a contrast.
struct DrawnLimit {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
};

/// Acuity 1/S75 (linear, x) against contrast (logarithmic, y): the TOD convention. 95 % intervals are horizontal.
/// Contrasts of either sign are drawn by their magnitude, negative ones as a series of their own.
[[nodiscard]] Plot tod_figure(const NamedCurve& first, const NamedCurve& second, std::span<const DrawnLimit> limits);
/// The same figure with its acuity axis linear, as is the convention, or logarithmic.
[[nodiscard]] Plot with_acuity_axis(Plot tod_figure, AxisScale scale);

/// Proportion correct with its intervals (proportion_interval()) against size, fitted functions, 75 % and 25 % lines
/// and the 95 % intervals of the thresholds. A null point is left out. `id` is unique on the page. The axis holds the
/// sizes that were answered and `expected_sizes_mrad`, those that a run is going to show.
struct NamedPoint {
  std::string name;
  const TodPoint* point = nullptr;  ///< borrowed for the call
};
[[nodiscard]] Plot psychometric_figure(const std::string& id, const NamedPoint& first, const NamedPoint& second,
                                       PsychometricForm form, std::span<const double> expected_sizes_mrad = {});

}  // namespace todbench
