#include "sim_devices/lab/correction_drift.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "acquisition/core/rng.h"

namespace todbench {

double CorrectionDrift::minutes(double since_s) const {
  constexpr double second = 1.0 / 60;
  if (time_constant_s <= 0) return second * since_s;
  return -second * time_constant_s * std::expm1(-since_s / time_constant_s);
}

cv::Mat1d drift_pattern(cv::Size size, std::uint64_t seed) {
  std::vector<float> draws(static_cast<std::size_t>(size.area()));
  RandomStream(seed, "laboratory.drift").fill_normal(draws);
  cv::Mat1d pattern(size);
  std::copy(draws.begin(), draws.end(), pattern.begin());
  cv::Scalar mean, sd;
  cv::meanStdDev(pattern, mean, sd);
  return cv::Mat1d((pattern - mean[0]) / sd[0]);
}

cv::Mat1w with_pattern(const cv::Mat1w& counts, const cv::Mat1d& pattern, double pattern_k, const SensorSpec& sensor) {
  cv::Mat1w out(counts.size());
  const double per_k = 1 / sensor.kelvin_per_count, top = std::exp2(sensor.bits) - 1;
  for (int j = 0; j < counts.rows; ++j) {
    for (int i = 0; i < counts.cols; ++i) {
      const double value = std::round(counts(j, i) + pattern_k * per_k * pattern(j, i));
      out(j, i) = static_cast<std::uint16_t>(std::clamp(value, 0.0, top));
    }
  }
  return out;
}

}  // namespace todbench
