// SPDX-License-Identifier: GPL-3.0-or-later
// A thread that runs jobs one after the other.
#pragma once

#include <QObject>
#include <QThread>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>

namespace todbench {

/// A started job stops the running one, drops the waiting ones and starts when the running one has ended. A queued job
/// starts after all others. Methods are called from the thread that owns the object and return at once; jobs run on the
/// runner's own thread.
class JobRunner final : public QObject {
  Q_OBJECT

 public:
  using Job = std::function<void(std::stop_token)>;
  explicit JobRunner(QObject* parent = nullptr);
  /// Stops the running job and waits for its end.
  ~JobRunner() override;

  void start(Job job);
  void queue(Job job);
  /// Whether stop() dropped jobs that had not started.
  enum class Waiting { none, dropped };
  /// Asks the running job to stop and drops the waiting ones.
  Waiting stop();
  /// Stops and waits for the end of the running job; later jobs do not run.
  void shut_down();
  /// Whether a job runs or waits.
  [[nodiscard]] bool busy() const;

 private:
  void run(const std::stop_token& end);

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Job> waiting_;
  std::optional<std::stop_source> running_;
  std::stop_source end_;
  std::unique_ptr<QThread> thread_;  ///< a QThread, because documents of a report have timers
};

}  // namespace todbench
