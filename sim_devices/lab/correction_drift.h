// SPDX-License-Identifier: GPL-3.0-or-later
// Drift of a camera after a non-uniformity correction.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Drift at the time t after a non-uniformity correction: rate * t, or rate * T * (1 - exp(-t / T)). `rate`: drift rate
/// just after the correction, in K per minute.
struct CorrectionDrift {
  double level_k_per_min = 0;    ///< drift of the level of the whole picture
  double pattern_k_per_min = 0;  ///< drift of the standard deviation over the pixels, whose drifts are normally random
  double time_constant_s = 0;    ///< T of both drifts; 0: linear drift

  [[nodiscard]] bool any() const { return level_k_per_min != 0 || pattern_k_per_min != 0; }
  /// Returns the drift after `since_s` seconds over the rate: minutes in which the initial rate gives this drift.
  [[nodiscard]] double minutes(double since_s) const;
};

/// Pattern of the drift, one random draw per pixel. Depends only on the seed.
struct DriftPattern {
  cv::Mat1d draw;   ///< mean 0 and standard deviation 1 over the picture; empty: no pattern
  cv::Mat1d phase;  ///< start of the rounding cycle of each pixel, 0 to 1
};
/// Returns the pattern of a seed.
[[nodiscard]] DriftPattern drift_pattern(cv::Size size, std::uint64_t seed);

/// Returns whole counts plus `pattern_k` times the pattern. The counts are rounded up or down from exposure to exposure
/// so that their mean over exposures also contains fractions of a count.
[[nodiscard]] cv::Mat1w with_pattern(const cv::Mat1w& counts, const DriftPattern& pattern, double pattern_k,
                                     std::uint64_t exposure, const SensorSpec& sensor);

}  // namespace todbench
