// A target that a stage moves before the camera at constant speed.
#pragma once

#include <array>
#include <optional>
#include <stop_token>

#include "acquisition/core/result.h"

namespace todbench {

/// A run of the plate along x, in its own plane, as seen by the camera. Lengths as TargetState::shift_mm.
struct PlateRun {
  double from_mm = 0, to_mm = 0;
  double speed_mm_s = 1;  ///< above 0
  /// When it left `from_mm`, in the clock of Frame::device_time_ns; nothing: stage and camera share no trigger.
  std::optional<double> start_s{};

  /// To the right: +1, to the left: -1.
  [[nodiscard]] double direction() const { return to_mm < from_mm ? -1 : 1; }
  [[nodiscard]] double duration_s() const { return direction() * (to_mm - from_mm) / speed_mm_s; }
};

/// What a Target is too, where it has a stage that runs. One thread at a time, that of the Target.
class MovingTarget {
 public:
  virtual ~MovingTarget() = default;
  /// Lowest and highest speed of a run.
  [[nodiscard]] virtual Result<std::array<double, 2>> run_speeds_mm_s(std::stop_token stop) = 0;
  /// Runs along x from where the presented state left the plate; returns once the stage says that it has begun. The
  /// next present() ends it. Errors: `invalid_input` (out of the stage's range), `disconnected`, `interrupted`.
  [[nodiscard]] virtual Result<PlateRun> run_along_x(double to_mm, double speed_mm_s, std::stop_token stop) = 0;
};

}  // namespace todbench
