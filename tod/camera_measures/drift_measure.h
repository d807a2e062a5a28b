// SPDX-License-Identifier: GPL-3.0-or-later
// Groups of frames of a flat field after a non-uniformity correction.
#pragma once

#include <opencv2/core.hpp>
#include <stop_token>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measures/drift_law.h"

namespace todbench {

/// Drift of a camera after a correction, in kelvin of the camera's scale.
struct DriftMeasure {
  int groups = 0, frames_each = 0;  ///< number of groups; number of frames in the smallest group
  double first_s = 0, last_s = 0;   ///< times of the first and the last group since the correction
  bool ended_by_correction = false;
  DriftLaw law;
};

/// Options of measure_drift().
struct DriftOptions {
  double drift_s = 20;       ///< duration of the observation, > 0
  double frame_rate_hz = 0;  ///< stated by the camera; 0: not stated
  bool commanded = false;    ///< true: a correction was just commanded; false: wait for an automatic correction of the
                             ///< camera
  /// True for a sensor model, which computes frames on request, uses a simulated clock and needs no correction.
  bool simulated = false;
};

/// Takes frames for `drift_s`, or until the next correction, and divides them into 20 groups of equal duration. If the
/// next correction occurs early, the groups are shorter. If no correction was commanded, the function first waits at
/// most `drift_s` for a correction that the camera reports or that the pictures show. Times are those of the camera's
/// clock if they agree with the stated frame rate, otherwise those of the host's clock. Errors: `integrity` (no
/// correction, or the next correction before eight groups), those of FrameTaker::next() and drift_law().
[[nodiscard]] Result<DriftMeasure> measure_drift(FrameTaker& taker, const cv::Rect& field, const DriftOptions& options,
                                                 const std::stop_token& stop);

}  // namespace todbench
