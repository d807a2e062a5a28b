// SPDX-License-Identifier: GPL-3.0-or-later
// Remaining time of a phase of work, without the time during which the camera was lost.
#pragma once

#include <chrono>
#include <optional>

namespace todbench {

/// Extrapolation of the elapsed time of a phase. The clock is an argument.
class TimeLeft {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Starts a phase.
  void begin(Time now);
  /// Excludes the time until the next progress(), because the work stops, for example after the loss of the camera.
  void stand_still(Time now);
  /// Returns the remaining time in seconds; `share` of the work is done, 0 to 1. Empty if `share` is not above 0.
  [[nodiscard]] std::optional<double> progress(Time now, double share);
  /// Returns whether a minute has passed since the start of the phase or the last line. If so, a new minute begins.
  [[nodiscard]] bool line_is_due(Time now);

 private:
  Time begin_{}, last_line_{};
  std::optional<Time> still_since_;
};

}  // namespace todbench
