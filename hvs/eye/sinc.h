// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer function of sample and hold.
#pragma once

#include <cmath>
#include <numbers>

namespace todbench {

/// Returns sin(pi x) / (pi x), and 1 at x = 0.
[[nodiscard]] inline double sinc(double x) {
  return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

}  // namespace todbench
