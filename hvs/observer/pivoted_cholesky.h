// SPDX-License-Identifier: GPL-3.0-or-later
// Low-rank factor of a covariance by pivoted Cholesky decomposition (Harbrecht, Peters and Schneider 2012).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace todbench {

/// Returns columns c_k whose sum over k of c_k c_k' approximates the covariance. The decomposition stops when at most
/// `max_left_out` of variance remains for every variable, or when there are `most` columns. `variances`: the diagonal;
/// `column_of`(index): a column of the covariance.
template <typename ColumnOf>
[[nodiscard]] std::vector<std::vector<double>> pivoted_cholesky(std::vector<double> variances, double max_left_out,
                                                                std::size_t most, ColumnOf column_of) {
  std::vector<double>& left = variances;
  std::vector<std::vector<double>> columns;
  while (columns.size() < std::min(left.size(), most)) {
    const auto at = static_cast<std::size_t>(std::max_element(left.begin(), left.end()) - left.begin());
    if (left[at] <= max_left_out) break;
    std::vector<double> column = column_of(at);
    for (const std::vector<double>& earlier : columns) {
      for (std::size_t t = 0; t < column.size(); ++t) column[t] -= earlier[t] * earlier[at];
    }
    const double root = std::sqrt(left[at]);
    for (std::size_t t = 0; t < column.size(); ++t) {
      column[t] /= root;
      left[t] -= column[t] * column[t];
    }
    left[at] = 0;
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace todbench
