// SPDX-License-Identifier: GPL-3.0-or-later
// Queue that executes runs one after the other on one thread and stores their states for clients.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>

#include "bench/run/experiment.h"
#include "bench/run/live_curve.h"
#include "bench/run_control/run_request.h"
#include "bench/serve/live_server.h"
#include "bench/text/json.h"

namespace todbench {

/// State of a run in the queue.
enum class QueuedRunState {
  queued,
  running,
  finished,  ///< the session has a verdict
  stopped,   ///< ended early, or removed from the queue; the reason is in the state
  failed,    ///< ended without data: a device could not be opened, or an error occurred at the start
};
/// Returns "queued", "running", "finished", "stopped" or "failed".
[[nodiscard]] std::string_view to_string(QueuedRunState state);

/// State of a run as JSON, with the number of its last change.
struct RunSnapshot {
  std::uint64_t version = 0;
  std::string json;
  bool over = false;
};

/// Queue of runs in order of their arrival, one at a time. All functions return immediately and can be called by any
/// thread; the thread of the run never waits for a client.
class RunQueue {
 public:
  static constexpr std::size_t most_waiting = 32;
  /// Largest number of runs whose states are stored. The sessions of older runs stay on disk.
  static constexpr std::size_t most_kept = 200;

  /// Creates the queue. Session folders are created in `sessions`. `changed` is called after every change of a state.
  RunQueue(std::filesystem::path sessions, std::function<void()> changed);
  /// Stops the current run, which ends its session in order.
  ~RunQueue();
  RunQueue(const RunQueue&) = delete;
  RunQueue& operator=(const RunQueue&) = delete;

  /// Adds a run to the queue and returns its id. Errors: `not_found` (queue full).
  [[nodiscard]] Result<std::string> add(RequestedRun run);
  /// Returns the state of a run; empty if there is no such run.
  [[nodiscard]] std::optional<RunSnapshot> snapshot(const std::string& id) const;
  /// Returns the states of all runs, oldest first.
  [[nodiscard]] Json list() const;
  /// Answers the request to the operator. `number` selects the request; empty selects the current request. Errors:
  /// `not_found` (no such run), `invalid_input` (no request, or a request with a different number).
  [[nodiscard]] Result<void> answer(const std::string& id, std::optional<std::uint64_t> number, OperatorAnswer answer);
  /// Stops a run or removes it from the queue. Has no effect on a run that is over. Errors: `not_found` (no such run).
  [[nodiscard]] Result<void> stop(const std::string& id);
  /// Returns the session folder; empty until it exists.
  [[nodiscard]] std::optional<std::filesystem::path> folder(const std::string& id) const;
  /// Returns curve and picture of a run; null before the first.
  [[nodiscard]] std::shared_ptr<const LivePages> pages(const std::string& id) const;
  /// Returns whether a run is using the devices.
  [[nodiscard]] bool is_running() const;
  [[nodiscard]] const std::filesystem::path& sessions() const { return sessions_; }

 private:
  struct Entry;
  void work(const std::stop_token& end);
  void run(const std::shared_ptr<Entry>& entry);
  [[nodiscard]] Result<ExperimentOutcome> run_shown(const std::shared_ptr<Entry>& entry);
  void finish(Entry& entry, const Result<ExperimentOutcome>& outcome);
  [[nodiscard]] Result<OperatorAnswer> ask(Entry& entry, const OperatorRequest& request, const std::stop_token& stop);
  [[nodiscard]] std::shared_ptr<Entry> find(const std::string& id) const;
  /// Notes a change. Requires the lock.
  static void touch(Entry& entry);

  std::filesystem::path sessions_;
  std::function<void()> changed_;
  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::uint64_t last_id_ = 0;
  std::map<std::uint64_t, std::shared_ptr<Entry>> entries_;
  std::deque<std::shared_ptr<Entry>> waiting_;
  std::shared_ptr<Entry> current_;
  std::jthread worker_;  // last: it uses everything above
};

}  // namespace todbench
