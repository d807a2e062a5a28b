// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/camera_measures/gain_control.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/normal.h"

namespace todbench {

namespace {

double magnitude_k(const GainLevel& level) {
  return std::abs(level.said_delta_t_k);
}

}  // namespace

Estimate GainLevel::gain() const {
  const double value = contrast / said_delta_t_k, half = std::abs(normal_z95 * contrast_u / said_delta_t_k);
  return {value, value - half, value + half};
}

const GainLevel& GainControlMeasure::smallest() const {
  return *std::ranges::min_element(levels, {}, magnitude_k);
}

const GainLevel& GainControlMeasure::largest() const {
  return *std::ranges::max_element(levels, {}, magnitude_k);
}

}  // namespace todbench
