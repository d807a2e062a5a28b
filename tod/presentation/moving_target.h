// SPDX-License-Identifier: GPL-3.0-or-later
// A target that a stage moves in front of the camera at constant speed.
#pragma once

#include <array>
#include <optional>
#include <stop_token>

#include "acquisition/base/result.h"

namespace todbench {

/// A run of the plate along x, in its own plane, as seen by the camera. Lengths as in TargetState::shift_mm.
struct PlateRun {
  double from_mm = 0, to_mm = 0;
  double speed_mm_s = 1;  ///< above 0
  /// Time at which it left `from_mm`, on the clock of Frame::device_time_ns; empty: stage and camera share no trigger.
  std::optional<double> start_s{};

  /// To the right: +1, to the left: -1.
  [[nodiscard]] double direction() const { return to_mm < from_mm ? -1 : 1; }
  [[nodiscard]] double duration_s() const { return direction() * (to_mm - from_mm) / speed_mm_s; }
};

/// Additional interface of a Target with a stage that can run. One thread at a time, that of the Target.
class MovingTarget {
 public:
  virtual ~MovingTarget() = default;
  /// Lowest and highest speed of a run.
  [[nodiscard]] virtual Result<std::array<double, 2>> run_speeds_mm_s(std::stop_token stop) = 0;
  /// Runs along x from the place of the presented state; returns once the stage reports that the run has begun. The
  /// next present() ends it. Errors: `invalid_input` (outside the stage's range), `disconnected`, `interrupted`.
  [[nodiscard]] virtual Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) = 0;
};

}  // namespace todbench
