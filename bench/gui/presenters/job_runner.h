// SPDX-License-Identifier: GPL-3.0-or-later
// Thread that runs jobs one after the other.
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

/// Thread for jobs. start() stops the running job and discards waiting jobs; the new job starts when the running job
/// has ended. queue() adds a job that starts after all others. Methods are called from the thread that owns the object
/// and return immediately; jobs run on the thread of the runner.
class JobRunner final : public QObject {
  Q_OBJECT

 public:
  using Job = std::function<void(std::stop_token)>;
  explicit JobRunner(QObject* parent = nullptr);
  /// Stops the running job and waits for its end.
  ~JobRunner() override;

  /// Stops the running job, discards waiting jobs, and starts this job.
  void start(Job job);
  /// Adds a job that starts after all others.
  void queue(Job job);
  /// Result of stop(): whether it discarded jobs that had not started.
  enum class Waiting { none, dropped };
  /// Requests a stop of the running job and discards the waiting jobs.
  Waiting stop();
  /// Stops and waits for the end of the running job; later jobs do not run.
  void shut_down();
  /// Returns whether a job runs or waits.
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
