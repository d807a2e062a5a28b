// One thread that does one job after the other.
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

/// A started job asks the running one to stop and begins when it has ended; jobs that wait are dropped for it. A queued
/// job leaves the others alone and begins after them.
/// Methods are called from the thread that owns the object and return at once; jobs run on the runner's own thread.
class JobRunner final : public QObject {
  Q_OBJECT

 public:
  using Job = std::function<void(std::stop_token)>;
  explicit JobRunner(QObject* parent = nullptr);
  /// Stops the running job and waits for its end.
  ~JobRunner() override;

  void start(Job job);
  void queue(Job job);
  /// What became of jobs that had not begun.
  enum class Waiting { none, dropped };
  /// Asks the running job to stop and drops those that wait.
  Waiting stop();
  /// Stops and waits for the end of the running job; nothing runs after it.
  void shut_down();
  /// A job runs or waits.
  [[nodiscard]] bool busy() const;

 private:
  void run(const std::stop_token& end);

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  std::deque<Job> waiting_;
  std::optional<std::stop_source> running_;
  std::stop_source end_;
  std::unique_ptr<QThread> thread_;  ///< Qt's own: documents of a report have timers
};

}  // namespace todbench
