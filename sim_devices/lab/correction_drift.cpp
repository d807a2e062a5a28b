// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/correction_drift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {

double CorrectionDrift::minutes(double since_s) const {
  constexpr double second = 1.0 / 60;
  if (time_constant_s <= 0) return second * since_s;
  return -second * time_constant_s * std::expm1(-since_s / time_constant_s);
}

DriftPattern drift_pattern(cv::Size size, std::uint64_t seed) {
  const RandomStream random(seed, "laboratory.drift");
  std::vector<float> draws(static_cast<std::size_t>(size.area()));
  random.fill_normal(draws);
  cv::Mat1d pattern(size), phase(size);
  std::copy(draws.begin(), draws.end(), pattern.begin());
  cv::Scalar mean, sd;
  cv::meanStdDev(pattern, mean, sd);
  const RandomStream phases = random.sub(1);
  std::uint64_t index = 0;
  for (double& value : phase) value = phases.uniform(index++);
  return {cv::Mat1d((pattern - mean[0]) / sd[0]), phase};
}

cv::Mat1w with_pattern(const cv::Mat1w& counts, const DriftPattern& pattern, double pattern_k, std::uint64_t exposure,
                       const SensorSpec& sensor) {
  cv::Mat1w out(counts.size());
  const double per_k = 1 / sensor.kelvin_per_count, top = std::exp2(sensor.bits) - 1;
  // Counts are already whole: rounding to the nearest would show the pattern in steps. Multiples of the golden ratio
  // are spread evenly.
  constexpr std::uint64_t period = 1 << 20;
  const double moved = 0.6180339887498949 * static_cast<double>(exposure % period);
  for (int j = 0; j < counts.rows; ++j) {
    for (int i = 0; i < counts.cols; ++i) {
      const double up = std::fmod(pattern.phase(j, i) + moved, 1);
      const double value = std::floor(counts(j, i) + pattern_k * per_k * pattern.draw(j, i) + up);
      out(j, i) = static_cast<std::uint16_t>(std::clamp(value, 0.0, top));
    }
  }
  return out;
}

}  // namespace todbench
