// What a camera drifts after a correction of its non-uniformity.
#pragma once

#include <opencv2/core.hpp>

#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Rates just after a correction; in time, rate t or rate T (1 - exp(-t / T)).
struct CorrectionDrift {
  double level_k_per_min = 0;    ///< of the whole picture
  double pattern_k_per_min = 0;  ///< standard deviation over the pixels, normal
  double time_constant_s = 0;    ///< T of both; 0: linear

  [[nodiscard]] bool any() const { return level_k_per_min != 0 || pattern_k_per_min != 0; }
  /// Minutes at the initial rate that lead to the same after `since_s`.
  [[nodiscard]] double minutes(double since_s) const;
};

/// One draw per pixel, the same for the same seed: mean 0 and standard deviation 1 over the picture.
[[nodiscard]] cv::Mat1d drift_pattern(cv::Size size, std::uint64_t seed);

/// Counts with the pattern of the drift on them, rounded again; `pattern` as drift_pattern() makes it.
[[nodiscard]] cv::Mat1w with_pattern(const cv::Mat1w& counts, const cv::Mat1d& pattern, double pattern_k,
                                     const SensorSpec& sensor);

}  // namespace todbench
