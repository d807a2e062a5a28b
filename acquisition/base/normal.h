// SPDX-License-Identifier: GPL-3.0-or-later
// The standard normal distribution.
#pragma once

#include <cmath>
#include <numbers>

namespace todbench {

/// Half-width of a two-sided 95 % interval of a normal distribution, in standard deviations.
inline constexpr double normal_z95 = 1.959963984540054;

/// Returns the density of the standard normal distribution.
[[nodiscard]] inline double normal_density(double x) {
  return std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
}

/// Returns the probability of a value below x. Small probabilities keep their relative accuracy.
[[nodiscard]] inline double normal_probability(double x) {
  return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

}  // namespace todbench
