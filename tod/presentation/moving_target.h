// SPDX-License-Identifier: GPL-3.0-or-later
// A target that a stage moves in front of the camera at constant speed.
#pragma once

#include <array>
#include <optional>
#include <stop_token>

#include "acquisition/base/result.h"

namespace todbench {

/// A run of the plate along x in the plane of the plate, as the camera sees it. Lengths are as in
/// TargetState::shift_mm.
struct PlateRun {
  double from_mm = 0, to_mm = 0;
  double speed_mm_s = 1;  ///< above 0
  /// Time at which the plate left `from_mm`, on the clock of Frame::device_time_ns; empty: stage and camera share no
  /// trigger.
  std::optional<double> start_s{};

  /// Returns +1 for a run to the right, and -1 for a run to the left.
  [[nodiscard]] double direction() const { return to_mm < from_mm ? -1 : 1; }
  [[nodiscard]] double duration_s() const { return direction() * (to_mm - from_mm) / speed_mm_s; }
};

/// Additional interface of a Target with a stage that can run. Use it only from the thread of the Target.
class MovingTarget {
 public:
  virtual ~MovingTarget() = default;
  /// Returns the lowest and highest speed of a run.
  [[nodiscard]] virtual Result<std::array<double, 2>> run_speeds_mm_s(std::stop_token stop) = 0;
  /// Starts a run along x from the position of the presented state. Returns when the stage reports that the run has
  /// begun. The next present() ends the run. Errors: `invalid_input` (outside the stage's range), `disconnected`,
  /// `interrupted`.
  [[nodiscard]] virtual Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) = 0;
};

}  // namespace todbench
