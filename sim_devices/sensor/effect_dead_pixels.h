// SPDX-License-Identifier: GPL-3.0-or-later
// Dead detectors: the camera shows the mean of their neighbours.
#pragma once

#include <opencv2/core.hpp>

#include "acquisition/base/rng.h"

namespace todbench {

/// Returns the mask of the dead detectors, one byte per detector, not 0 if dead. `share`: share of dead detectors. The
/// random number of a detector is the same for all shares: a larger share includes the dead detectors of a smaller one.
[[nodiscard]] cv::Mat1b dead_detectors(cv::Size detectors, double share, const RandomStream& stream);

/// Replaces samples of dead detectors by the mean of up to four nearest live neighbours in the same sub-exposure.
/// Samples without a live neighbour keep their value.
void replace_dead(cv::Mat1f& picture, const cv::Mat1b& dead, int samples_per_pitch);

}  // namespace todbench
