// SPDX-License-Identifier: GPL-3.0-or-later
// Median of a sample.
#pragma once

#include <algorithm>
#include <vector>

namespace todbench {

/// Returns the median; for an even number of values, the mean of the two middle values. Precondition: at least one
/// value.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace todbench
