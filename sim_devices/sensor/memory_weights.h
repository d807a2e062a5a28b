// SPDX-License-Identifier: GPL-3.0-or-later
// Weights for random numbers that are correlated from exposure to exposure (first-order autoregressive).
#pragma once

#include <vector>

namespace todbench {

/// Returns the weights w(j) of the independent random numbers z of this exposure and of earlier exposures: x(t) = sum
/// over j of w(j) z(t - j), w(j) proportional to rho^j. The squares of the weights sum to 1. Correlations below 1 % are
/// set to zero, which limits the work for each exposure. The error of the correlations is at most 1 %, and between
/// successive exposures at most 0.01 %. `rho`: correlation of successive exposures, in [0, 1).
[[nodiscard]] std::vector<double> memory_weights(double rho);

}  // namespace todbench
