// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of a report: TOD curve and one psychometric function per contrast.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/report/plot.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Answers at one size, summed over presentations.
struct AnswersAtSize {
  double size_mrad = 0;
  double correct = 0, total = 0;  ///< sum of probabilities for graded answers
  /// Number of groups (presentations or positions), and sums over the groups: squares of `correct`, products of
  /// `correct` and `total`, squares of `total`.
  double groups = 0, squares = 0, products = 0, total_squares = 0;
  bool graded = false;
};

/// Sums levels of equal size (within 1e-6). Returns the sums by increasing size and omits sizes without trials.
[[nodiscard]] std::vector<AnswersAtSize> answers_by_size(const TodPoint& point);

/// Returns Wilson's 95 % score interval of a proportion (Wilson 1927; Brown, Cai and DasGupta 2001, eq. 4). Both limits
/// are open if total is 0.
[[nodiscard]] Interval wilson_interval(double correct, double total);

/// Returns the 95 % interval of the proportion at a size. Binary answers: Wilson's interval, with all answers treated
/// as independent. Graded answers scatter less than binomially. The interval of graded answers is therefore m -+ t s,
/// limited to 0 and 1, with s^2 = K / (K - 1) sum (c - m n)^2 / N^2. The sum is over the K presentations, each with n
/// trials and the sum c of their graded answers. N is the number of all trials, m = sum c / N, and t is Student's t.
/// The interval is open for fewer than two presentations, and wider than necessary if the effects of the phases in a
/// set-up cancel.
[[nodiscard]] Interval proportion_interval(const AnswersAtSize& answers);

/// Curve with its name in figures.
struct NamedCurve {
  std::string name;                 ///< "measured", "simulated"
  const TodCurve* curve = nullptr;  ///< not owned; null: absent
};

/// Least acuity that a limit requires at a contrast.
struct DrawnLimit {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
};

/// Returns the plot of acuity 1/S75 (linear, x) against contrast (logarithmic, y), the TOD convention. 95 % intervals
/// are horizontal. Contrasts are drawn by magnitude; negative contrasts are a separate series.
[[nodiscard]] Plot tod_figure(const NamedCurve& first, const NamedCurve& second, std::span<const DrawnLimit> limits);
/// Returns the same figure with a linear (the convention) or logarithmic acuity axis.
[[nodiscard]] Plot with_acuity_axis(Plot tod_figure, AxisScale scale);

/// Point of a curve with its name. A null point is not drawn.
struct NamedPoint {
  std::string name;
  const TodPoint* point = nullptr;  ///< not owned
};
/// Returns the plot of the proportion correct with its intervals (proportion_interval()) against size, with fitted
/// functions, 75 % and 25 % lines and the 95 % intervals of the thresholds. `id` is unique on the page. The size axis
/// covers the answered sizes and `expected_sizes_mrad`, the sizes that a run will show.
[[nodiscard]] Plot psychometric_figure(const std::string& id, const NamedPoint& first, const NamedPoint& second,
                                       PsychometricForm form, std::span<const double> expected_sizes_mrad = {});

}  // namespace todbench
