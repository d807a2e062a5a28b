// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the scatter of answers about a fitted function is too large, too small, or as expected by chance.
#pragma once

#include <span>

#include "tod/adequacy/residual_directions.h"

namespace todbench {

/// Ratio of the sum of squares of standardised residuals to its expectation under the model.
struct Dispersion {
  double ratio = 1;  ///< observed / expected
  /// Degrees of freedom of a chi-square distribution; the ratio follows this distribution divided by its mean. 0: no
  /// test is possible.
  double degrees_of_freedom = 0;
  /// Degrees of freedom of the expectation, if it is estimated from clusters. 0: the expectation is exact.
  double denominator_freedom = 0;
  /// Return the probability, under the model, of a ratio of at least `ratio` (p_more) or at most `ratio` (p_less).
  [[nodiscard]] double p_more() const;
  [[nodiscard]] double p_less() const;
  /// Return the ratio above which (upper) or below which (lower) a result occurs by chance with this probability.
  [[nodiscard]] double upper_limit(double probability) const;
  [[nodiscard]] double lower_limit(double probability) const;
};

/// Tests of the same answers for too much scatter (more) and for too little scatter (less). The expected scatter can be
/// computed for clusters or for independent trials. With clusters, each test uses the expectation that causes fewer
/// findings.
struct Dispersions {
  Dispersion more, less;
};

/// Returns Pearson's statistic over groups of neighbouring sizes. Each group has enough trials for a chi-square
/// distribution (at least four times the variance of one answer). The statistic is orthogonal to the fitted parameters
/// and to the directions in `besides`, and uses the exact covariance. For clustered data, its distribution is that of
/// Rao and Scott (1984) with the second-order correction. If trials are independent and a size has several levels,
/// Pearson's statistic of these levels is added, with its exact conditional mean and variance (Dawson 1954).
/// `clusters`: number of clusters of the fit; 0: independent trials.
[[nodiscard]] Dispersions dispersions(const ModelResiduals& model, std::span<const Level> levels,
                                      std::span<const Direction> besides, double clusters);

}  // namespace todbench
