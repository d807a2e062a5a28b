// A run as the live page shows it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "acquisition/core/frame.h"
#include "bench/run/experiment.h"
#include "bench/run/live_curve.h"
#include "bench/serve/live_server.h"

namespace todbench {

/// What a run is about, for who looks once in a while.
enum class LiveStatus {
  running,
  settling,         ///< plate, mounting and place are there, the contrast is not
  plate_change,     ///< the stage is on its way
  operator_needed,  ///< somebody has to do the step
  camera_lost,      ///< waited for
  finished,
  stopped,  ///< before its end, with the reason
};
/// "running", "settling", "plate-change", "operator", "camera-lost", "finished", "stopped".
[[nodiscard]] std::string_view to_string(LiveStatus status);

/// What state.json says: one object with these names, numbers and texts (`status` as "state"); `verdict` is null until
/// there is one, `reason` unless the run stopped.
struct LiveState {
  LiveStatus status = LiveStatus::running;
  std::string name, phase, waiting;
  std::string step{};  ///< what the operator is asked to do, a line a step
  std::uint64_t done = 0, planned = 0;
  std::optional<std::string> verdict{}, reason{};
  std::uint64_t curve = 0, picture = 0;  ///< change with curve.svg and picture.png; 0: there is none
  bool over = false;
};
[[nodiscard]] std::string to_json(const LiveState& state);

/// The picture of a frame in grey, from its 0.05 % to its 99.95 % quantile; empty where there are no pixels.
[[nodiscard]] std::string picture_of(const Frame& frame);

/// Draws and encodes on a thread of its own, about twice a second. The functions of the run only leave values.
class LiveRun {
 public:
  /// `server` and `curve` outlive it.
  LiveRun(LiveServer& server, const LiveCurve& curve, const Plan& plan);

  /// `listener`, and the page beside it.
  [[nodiscard]] ExperimentListener listening(const ExperimentListener& listener);
  /// What the operator is asked; empty: nothing any more.
  void ask(const std::string& step);
  /// The last state: hands it over before it returns. `reason`: why the run stopped before its end.
  void end(const std::string& phase, const std::optional<std::string>& verdict,
           const std::optional<std::string>& reason = std::nullopt);

 private:
  void work(const std::stop_token& stop);
  void render();
  /// With the lock: what matters most of what goes on.
  void set_status();

  LiveServer& server_;
  const LiveCurve& curve_;
  Plan plan_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  LiveState state_;
  LiveStatus target_ = LiveStatus::running;  ///< what the target is waited for
  bool lost_ = false;
  std::optional<Frame> frame_;
  std::mutex rendering_;  ///< one at a time: the thread's or that of end()
  std::string curve_svg_, picture_png_;
  std::uint64_t drawn_version_ = 0, pictures_ = 0;
  std::jthread worker_;  // last: it uses everything above
};

}  // namespace todbench
