// Who commands a measurement: its clock, its rests, the way back of a lost camera. Who only listens is a
// MeasurementListener.
#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <string_view>

#include "acquisition/core/host_clock.h"
#include "acquisition/core/result.h"

namespace todbench {

/// What a measurement reads the clock for.
enum class Moment {
  correction_due,  ///< whether the non-uniformity has to be corrected again
  corrected,       ///< the camera has carried out the command to correct
  scene_changed,   ///< the target is there; frames from now on show it
  camera_lost,     ///< the camera failed
  camera_back,     ///< the presentation in which it failed was made again
};
inline constexpr std::array all_moments{Moment::correction_due, Moment::corrected, Moment::scene_changed,
                                        Moment::camera_lost, Moment::camera_back};
[[nodiscard]] std::string_view to_string(Moment moment);

/// What becomes of the frames that a camera sends while the target changes.
enum class FramesMeanwhile {
  leave,  ///< nobody asks for them: a camera that exposes only when it is asked
  take,   ///< taken as they come, on a thread of their own, so that no queue has to hold the minutes in which a black
          ///< body settles, and no correction in them is missed
  repeat  ///< taken as often as MeasurementHost::asked_while_presenting() says: a replay
};

/// Everything that a run obeys beside its plan. What it answers decides which trials are made, so a recording keeps
/// every answer and a replay gives the same ones. Called from the measuring thread, in the order of the measurement; an
/// error of any function ends the run with it. Outlives the run.
class MeasurementHost {
 public:
  virtual ~MeasurementHost() = default;
  /// The clock of Frame::host_time_ns, now.
  [[nodiscard]] virtual Result<std::int64_t> now_ns(Moment why) = 0;
  /// Asked before every presentation, and again while it says true; may take a tenth of a second to answer, less when
  /// `stop` is requested.
  [[nodiscard]] virtual Result<bool> rests(std::stop_token stop) = 0;
  /// The same throughout a run.
  [[nodiscard]] virtual FramesMeanwhile frames_while_presenting() const = 0;
  /// Unless frames are left: told after the target answered how often a frame was asked for meanwhile, and says how
  /// often it was. A replay is told 0.
  [[nodiscard]] virtual Result<std::int64_t> asked_while_presenting(std::int64_t calls) = 0;
  /// Whether recover() may succeed. False: a lost camera ends the run, and it is not called.
  [[nodiscard]] virtual bool recovers() const = 0;
  /// The camera was lost. Success: the same source delivers frames again, started and set as before; then the plate is
  /// looked for again and the presentation is repeated. Errors: `disconnected` (it stays away), `interrupted`.
  [[nodiscard]] virtual Result<void> recover(std::stop_token stop) = 0;
  /// The plate was found again after a loss, and the presentation was made.
  virtual void resumed() = 0;
};

/// The host of a run that nobody lets rest and whose camera does not come back: a simulation.
class UnattendedHost final : public MeasurementHost {
 public:
  [[nodiscard]] Result<std::int64_t> now_ns(Moment) override { return monotonic_ns(); }
  [[nodiscard]] Result<bool> rests(std::stop_token) override { return false; }
  [[nodiscard]] FramesMeanwhile frames_while_presenting() const override { return FramesMeanwhile::leave; }
  [[nodiscard]] Result<std::int64_t> asked_while_presenting(std::int64_t calls) override { return calls; }
  [[nodiscard]] bool recovers() const override { return false; }
  [[nodiscard]] Result<void> recover(std::stop_token) override {
    return fail(ErrorCode::disconnected, "nobody waits for the camera");
  }
  void resumed() override {}
};

}  // namespace todbench
