// SPDX-License-Identifier: GPL-3.0-or-later
// State of a run for the live page.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
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

/// Activity of a run, for an occasional viewer.
enum class LiveStatus {
  running,
  settling,         ///< plate, mounting and position are set; the contrast is not yet stable
  plate_change,     ///< the stage is moving
  operator_needed,  ///< the operator must do the step
  camera_lost,      ///< waiting for the camera
  finished,
  stopped,  ///< ended early, with the reason
};
/// Returns "running", "settling", "plate-change", "operator", "camera-lost", "finished" or "stopped".
[[nodiscard]] std::string_view to_string(LiveStatus status);

/// Content of state.json: one object whose keys are the names of these members ("state" for `status`). `verdict` is
/// null until it exists, `reason` is null unless the run stopped.
struct LiveState {
  LiveStatus status = LiveStatus::running;
  std::string name, phase, waiting;
  std::string step{};  ///< request to the operator, one line per step
  std::uint64_t done = 0, planned = 0;
  std::optional<std::string> verdict{}, reason{};
  std::uint64_t curve = 0, picture = 0;  ///< version numbers of curve.svg and picture.png; 0: absent
  bool over = false;
};
/// Returns the content of state.json.
[[nodiscard]] std::string to_json(const LiveState& state);

/// Returns a frame as a grey PNG from its 0.05 % to its 99.95 % quantile; empty if the frame has no pixels.
[[nodiscard]] std::string picture_of(const Frame& frame);

/// Renders curve and picture on its own thread, about twice a second. Calls from the run only store values and
/// therefore do not delay the run.
class LiveRun {
 public:
  /// Receives new content, on the drawing thread or on the thread of end().
  using Show = std::function<void(std::shared_ptr<const LivePages>)>;
  /// Shows the content with a function. `curve` must outlive this object.
  LiveRun(Show show, const LiveCurve& curve, const Plan& plan);
  /// Shows the content on a server, which must outlive this object.
  LiveRun(LiveServer& server, const LiveCurve& curve, const Plan& plan);

  /// Returns a listener that calls `listener` and updates the page.
  [[nodiscard]] ExperimentListener listening(const ExperimentListener& listener);
  /// Sets the request to the operator; empty: none.
  void ask(const std::string& step);
  /// Publishes the last state before it returns. `reason`: cause of an early end.
  void end(const std::string& phase, const std::optional<std::string>& verdict,
           const std::optional<std::string>& reason = std::nullopt);

 private:
  void work(const std::stop_token& stop);
  void render();
  /// Sets the status to the most important condition that currently holds. Requires the lock.
  void set_status();

  Show show_;
  const LiveCurve& curve_;
  Plan plan_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  LiveState state_;
  LiveStatus target_ = LiveStatus::running;  ///< status while waiting for the target
  bool lost_ = false;
  std::optional<Frame> frame_;
  std::mutex rendering_;  ///< held while rendering, by the worker or by end()
  std::string curve_svg_, picture_png_;
  std::uint64_t drawn_version_ = 0, pictures_ = 0;
  std::jthread worker_;  // last member: it uses all others
};

}  // namespace todbench
