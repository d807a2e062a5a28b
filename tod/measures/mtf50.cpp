// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/mtf50.h"

#include <cstddef>

namespace todbench {
namespace {

/// First index from 1 on whose value is at most 0.5; the size without one.
std::size_t first_at_most_half(const std::vector<double>& values) {
  std::size_t i = 1;
  while (i < values.size() && values[i] > 0.5) ++i;
  return i;
}

}  // namespace

std::optional<double> first_half(const std::vector<double>& frequency, const std::vector<double>& values) {
  const std::size_t i = first_at_most_half(values);
  if (i >= values.size()) return std::nullopt;
  const double share = (values[i - 1] - 0.5) / (values[i - 1] - values[i]);
  return frequency[i - 1] + share * (frequency[i] - frequency[i - 1]);
}

Interval mtf50_interval(const std::vector<double>& frequency, const std::vector<double>& low,
                        const std::vector<double>& high) {
  const std::size_t i = first_at_most_half(low);
  const bool known = i < low.size() && low[i] > 0;
  return {known ? first_half(frequency, low) : std::nullopt, first_half(frequency, high)};
}

}  // namespace todbench
