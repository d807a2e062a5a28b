// SPDX-License-Identifier: GPL-3.0-or-later
// Interface of the code that controls a measurement: clock, pauses, recovery of a lost camera. Use a
// MeasurementListener for code that only observes the measurement.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <string_view>

#include "acquisition/base/host_clock.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Reason why a measurement reads the clock.
enum class Moment {
  correction_due,  ///< the measurement decides whether a non-uniformity correction is due
  corrected,       ///< the camera has carried out the command to correct
  scene_changed,   ///< the target is in place; later frames show it
  camera_lost,     ///< the camera failed
  camera_back,     ///< the presentation in which the camera failed was repeated
};
inline constexpr std::array all_moments{Moment::correction_due, Moment::corrected, Moment::scene_changed,
                                        Moment::camera_lost, Moment::camera_back};
[[nodiscard]] std::string_view to_string(Moment moment);

/// Treatment of the frames that a camera sends while the target changes.
enum class FramesWhilePresenting {
  leave,  ///< not requested: for a camera that exposes only on request
  take,   ///< taken by a separate thread, to keep queues short and to detect every correction
  repeat  ///< for a replay: RunController::asked_while_presenting() returns the recorded number of requests
};

/// External inputs of a run: clock, pauses, frame requests and recovery of a lost camera. The returned values affect
/// the trials. A recording therefore stores all returned values, and a replay returns the same values. Called from the
/// measuring thread, in the order of the measurement. If a function returns an error, the run ends with this error.
/// Must outlive the run.
class RunController {
 public:
  virtual ~RunController() = default;
  /// Returns the present time on the clock of Frame::host_time_ns.
  [[nodiscard]] virtual Result<std::int64_t> now_ns(Moment why) = 0;
  /// Returns whether the run is paused. Called before every presentation, and repeatedly while the run is paused. May
  /// block for up to 0.1 s; returns early if `stop` is requested.
  [[nodiscard]] virtual Result<bool> rests(std::stop_token stop) = 0;
  /// Returns the treatment of frames while the target changes. The value is constant during a run.
  [[nodiscard]] virtual FramesWhilePresenting frames_while_presenting() const = 0;
  /// Called after the target has presented a state. `calls`: number of frames requested during the change; 0 in a
  /// replay. Returns this number; in a replay, the recorded number. Not called for FramesWhilePresenting::leave.
  [[nodiscard]] virtual Result<std::int64_t> asked_while_presenting(std::int64_t calls) = 0;
  /// Returns whether recover() may succeed. If false, a lost camera ends the run, and recover() is not called.
  [[nodiscard]] virtual bool recovers() const = 0;
  /// Called when the camera was lost. After success the same source, started and configured as before, must deliver
  /// frames again. The measurement then locates the plate again and repeats the presentation. Errors: `disconnected`
  /// (the camera does not return), `interrupted`.
  [[nodiscard]] virtual Result<void> recover(std::stop_token stop) = 0;
  /// Called when the plate was located again after a loss and the presentation was repeated.
  virtual void resumed() = 0;
};

/// Host of a run without pauses and without recovery of the camera, for example of a simulation.
class UnattendedHost final : public RunController {
 public:
  [[nodiscard]] Result<std::int64_t> now_ns(Moment) override { return monotonic_ns(); }
  [[nodiscard]] Result<bool> rests(std::stop_token) override { return false; }
  [[nodiscard]] FramesWhilePresenting frames_while_presenting() const override { return FramesWhilePresenting::leave; }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override { return calls; }
  [[nodiscard]] bool recovers() const override { return false; }
  [[nodiscard]] Result<void> recover(std::stop_token) override {
    return fail(ErrorCode::disconnected, "this run does not wait for a lost camera");
  }
  void resumed() override {}
};

}  // namespace todbench
