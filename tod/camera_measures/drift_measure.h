// Frames of a flat field from a correction of the camera's non-uniformity on, in groups.
#pragma once

#include <opencv2/core.hpp>
#include <stop_token>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/measurement/frame_taker.h"
#include "tod/measures/drift_law.h"

namespace todbench {

/// How a camera drifts after a correction, in kelvin of its own scale.
struct DriftMeasure {
  int groups = 0, frames_each = 0;  ///< frames: the fewest of a group
  double first_s = 0, last_s = 0;   ///< of the groups, since the correction
  bool ended_by_correction = false;
  DriftLaw law;
};

struct DriftOptions {
  double drift_s = 20;       ///< over which the camera is watched, > 0
  double frame_rate_hz = 0;  ///< stated by the camera; 0: it states none
  bool commanded = false;    ///< the correction was commanded just now; otherwise the camera's own is waited for
  /// A sensor model: frames are made when they are asked for, time is that of its clock, it needs no correction.
  bool simulated = false;
};

/// Times are those of the camera's clock, where it counts frames at the stated rate, otherwise those of the host's.
/// Takes the frames of `drift_s` in 20 groups of one length of time, up to the next correction; in shorter groups where
/// that comes early. Where none was
/// commanded one is waited for as long again: the camera tells of it, or it is seen in the pictures. Errors:
/// `integrity` where none comes, or the next comes before eight groups; those of FrameTaker::next() and drift_law().
[[nodiscard]] Result<DriftMeasure> measure_drift(FrameTaker& taker, const cv::Rect& field, const DriftOptions& options,
                                                 const std::stop_token& stop);

}  // namespace todbench
