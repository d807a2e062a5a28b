// SPDX-License-Identifier: GPL-3.0-or-later
// Random numbers with memory: first-order autoregressive from exposure to exposure, made of independent numbers.
#pragma once

#include <vector>

namespace todbench {

/// Weights w(j) of the independent numbers z of this exposure and of earlier ones: x(t) = sum over j of w(j) z(t - j),
/// w(j) proportional to rho^j, squares sum to 1. Memory below 1 % is cut off, so that each exposure takes bounded work.
/// Correlations are in error by at most 1 %, that of successive exposures by at most 0.01 %. `rho` in [0, 1).
[[nodiscard]] std::vector<double> memory_weights(double rho);

}  // namespace todbench
