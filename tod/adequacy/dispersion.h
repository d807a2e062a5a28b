// Whether answers scatter about a fitted function as chance says: more, less, or as they should.
#pragma once

#include <span>

#include "tod/adequacy/residual_directions.h"

namespace todbench {

/// Sum of squares of standardised residuals over what chance makes it.
struct Dispersion {
  double ratio = 1;                ///< found / expected
  double degrees_of_freedom = 0;   ///< of the chi-square, over its mean, that the ratio is; 0: nothing can be said
  double denominator_freedom = 0;  ///< of the expectation where it comes from clusters; 0: exact
  /// Under the model, of a ratio as large or larger; as small or smaller.
  [[nodiscard]] double p_more() const;
  [[nodiscard]] double p_less() const;
  /// Ratio that chance exceeds, or stays below, with this probability.
  [[nodiscard]] double upper_limit(double probability) const;
  [[nodiscard]] double lower_limit(double probability) const;
};

/// The same answers as evidence of too much scatter and of too little. Where clusters make the expectation each has the
/// more cautious one of theirs and that of independent trials.
struct Dispersions {
  Dispersion more, less;
};

/// Pearson's statistic over groups of neighbouring sizes with enough trials for a chi-square (four times the variance
/// of one answer and more; single trials at a size say nothing alone), orthogonal to the fitted parameters and to
/// `besides`, with its exact covariance; in clustered data its distribution is that of Rao and Scott (1984) with the
/// second-order correction. Where trials are independent and a size has several rows, Pearson's statistic of those
/// rows with its exact conditional mean and variance (Dawson 1954) is added. `clusters`: of the fit, 0 for independent
/// trials.
[[nodiscard]] Dispersions dispersions(const ModelResiduals& model, std::span<const Level> levels,
                                      std::span<const Direction> besides, double clusters);

}  // namespace todbench
