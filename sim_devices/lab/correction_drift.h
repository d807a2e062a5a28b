// What a camera drifts after a correction of its non-uniformity.
#pragma once

#include <cstdint>
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

/// One draw per pixel, the same for the same seed.
struct DriftPattern {
  cv::Mat1d draw;   ///< mean 0 and standard deviation 1 over the picture; empty: there is no pattern
  cv::Mat1d phase;  ///< of the rounding, 0 to 1
};
[[nodiscard]] DriftPattern drift_pattern(cv::Size size, std::uint64_t seed);

/// Whole counts with `pattern_k` times the pattern on them: of successive exposures so many are rounded up that their
/// mean has parts of a count, too.
[[nodiscard]] cv::Mat1w with_pattern(const cv::Mat1w& counts, const DriftPattern& pattern, double pattern_k,
                                     std::uint64_t exposure, const SensorSpec& sensor);

}  // namespace todbench
