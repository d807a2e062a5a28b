// Detectors that do not see: the camera shows the mean of their neighbours.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/core/rng.h"

namespace todbench {

/// Which detectors are dead, a byte each, at the share of the sensor; the same numbers for every share.
[[nodiscard]] cv::Mat1b dead_detectors(cv::Size detectors, double share, const RandomStream& stream);

/// Samples of dead detectors become the mean of the same sub-exposure's samples of the up to four nearest live
/// neighbours; without any they stay.
void replace_dead(cv::Mat1f& picture, const cv::Mat1b& dead, int samples_per_pitch);

}  // namespace todbench
