// SPDX-License-Identifier: GPL-3.0-or-later
#include "hvs/shape/gauss_legendre.h"

#include <cmath>
#include <numbers>

namespace todbench {

std::vector<QuadratureNode> gauss_legendre(int count) {
  std::vector<QuadratureNode> rule(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    // Tricomi's estimate of the root, then Newton's method until it no longer changes.
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double derivative = 1;
    for (int iteration = 0; iteration < 20; ++iteration) {
      double previous = 1;
      double value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
        previous = value;
        value = next;
      }
      if (count == 1) previous = 1;
      derivative = count * (previous - x * value) / (1 - x * x);
      const double step = value / derivative;
      x -= step;
      if (std::abs(step) < 1e-16) break;
    }
    rule[static_cast<std::size_t>(i)] = {x, 2 / ((1 - x * x) * derivative * derivative)};
  }
  return rule;
}

}  // namespace todbench
