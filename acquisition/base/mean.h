// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic mean.
#pragma once

#include <numeric>
#include <span>

namespace todbench {

/// Returns the arithmetic mean; NaN for an empty span.
[[nodiscard]] inline double arithmetic_mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace todbench
