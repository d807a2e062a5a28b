// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/gain_control.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"

namespace todbench {

namespace {

double magnitude_k(const GainLevel& level) {
  return std::abs(level.said_delta_t_k);
}

}  // namespace

Estimate GainLevel::gain() const {
  constexpr double upper_tail = 0.025;
  const double quantile =
      distribution::quantile_above(upper_tail, triangles > 1 ? std::optional<double>(triangles - 1) : std::nullopt);
  const double value = contrast / said_delta_t_k, half = std::abs(quantile * contrast_u / said_delta_t_k);
  return {value, value - half, value + half};
}

const GainLevel& GainControlMeasure::smallest() const {
  return *std::ranges::min_element(levels, {}, magnitude_k);
}

const GainLevel& GainControlMeasure::largest() const {
  return *std::ranges::max_element(levels, {}, magnitude_k);
}

Estimate GainControlMeasure::ratio() const {
  const Estimate large = largest().gain(), small = smallest().gain();
  const double value = large.value / small.value;
  const double of_large = (large.high - large.low) / (2 * std::abs(large.value));
  const double of_small = (small.high - small.low) / (2 * std::abs(small.value));
  const bool opposite = (largest().said_delta_t_k > 0) != (smallest().said_delta_t_k > 0);
  const double half = std::abs(value) * (opposite ? of_large + of_small : std::hypot(of_large, of_small));
  return {value, value - half, value + half};
}

}  // namespace todbench
