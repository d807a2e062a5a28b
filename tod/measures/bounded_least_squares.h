// SPDX-License-Identifier: GPL-3.0-or-later
// Least squares with a lower and an upper bound of every unknown.
#pragma once

#include <cstddef>
#include <vector>

namespace todbench {

/// Minimises q(x) = x'Gx - 2 r'x with low <= x <= high. G is positive semidefinite: the Gram matrix of a design,
/// divided by the variance of a sample. q is therefore chi-square except for a constant. Columns are scaled to equal
/// length. A ridge of 1e-13 of this length makes the solution unique if columns are dependent.
///
/// Active-set method (Stark and Parker 1995). It ends after a finite number of steps and is exact except for rounding.
/// 36 unknowns take about 50 us without a starting point.
class BoundedLeastSquares {
 public:
  /// Solves the problem. `gram`: G, stored by rows; `right`: r. Precondition: low <= high, matching sizes, no NaN.
  /// Bounds may be infinite.
  BoundedLeastSquares(const std::vector<double>& gram, const std::vector<double>& right, const std::vector<double>& low,
                      const std::vector<double>& high);

  /// Returns the x of the minimum.
  [[nodiscard]] const std::vector<double>& best() const { return best_.x; }
  /// Returns q(x) - q(best), at least 0.
  [[nodiscard]] double excess(const std::vector<double>& x) const;
  /// Returns the x with the largest direction'x among all x with an excess of at most `allowed`.
  [[nodiscard]] std::vector<double> farthest(const std::vector<double>& direction, double allowed) const;

 private:
  struct State {
    std::vector<double> x;
    std::vector<signed char> bound;  ///< -1 at the lower bound, 1 at the upper bound, 0 free
  };
  [[nodiscard]] State solve(const std::vector<double>& right, State from) const;
  [[nodiscard]] std::vector<double> free_minimum(const std::vector<double>& right, const State& state,
                                                 const std::vector<std::size_t>& free) const;
  [[nodiscard]] double scaled_excess(const std::vector<double>& x) const;
  [[nodiscard]] std::vector<double> unscaled(std::vector<double> x) const;

  std::size_t n_;
  std::vector<double> scale_, gram_, right_, low_, high_;  ///< problem in scaled unknowns, x / scale
  State scaled_best_, best_;
  std::vector<double> slope_at_best_;  ///< half the gradient of q
};

}  // namespace todbench
