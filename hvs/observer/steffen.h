// SPDX-License-Identifier: GPL-3.0-or-later
// Interpolation that preserves monotonicity.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace todbench {

/// Returns the interpolated value at x in [0, 1] between y[1] and y[2]. The four values are at x = -1, 0, 1, 2. The
/// interpolant is a cubic with a continuous first derivative. Its values always lie between y[1] and y[2] (Steffen
/// 1990, Astron. Astrophys. 239, 443, eq. 11).
[[nodiscard]] inline double steffen(const std::array<double, 4>& y, double x) {
  const auto slope = [](double before, double after) {
    const double sign = (before > 0 ? 1.0 : -1.0) + (after > 0 ? 1.0 : -1.0);
    return sign * std::min({std::abs(before), std::abs(after), std::abs(before + after) / 4});
  };
  const double left = slope(y[1] - y[0], y[2] - y[1]);
  const double middle = y[2] - y[1];
  const double right = slope(y[2] - y[1], y[3] - y[2]);
  const double a = left + right - 2 * middle;
  const double b = 3 * middle - 2 * left - right;
  return ((a * x + b) * x + left) * x + y[1];
}

}  // namespace todbench
