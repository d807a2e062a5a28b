// SPDX-License-Identifier: GPL-3.0-or-later
// The contrast of a plan that is farthest from zero.
#pragma once

#include <cmath>
#include <span>

namespace todbench {

/// Returns the contrast with the largest magnitude, with its sign. If several contrasts have this magnitude, it returns
/// the first of them. 0 for an empty span.
[[nodiscard]] inline double largest_contrast_k(std::span<const double> contrasts_k) {
  double largest_k = 0;
  for (const double k : contrasts_k) largest_k = std::abs(k) > std::abs(largest_k) ? k : largest_k;
  return largest_k;
}

}  // namespace todbench
