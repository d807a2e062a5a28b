// Numbers that remember: first-order autoregressive from exposure to exposure, made of independent ones.
#pragma once

#include <vector>

namespace todbench {

/// What the independent numbers of this exposure and of those before it add up to: x(t) = sum over j of w(j) z(t - j),
/// w(j) proportional to rho^j, squares that sum to 1. Memory below 1 % is cut off, so that an exposure takes bounded
/// work wherever it is in the sequence: every correlation is right to it, that of successive exposures to its square.
/// `rho` in [0, 1).
[[nodiscard]] std::vector<double> memory_weights(double rho);

}  // namespace todbench
