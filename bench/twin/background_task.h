// SPDX-License-Identifier: GPL-3.0-or-later
// Value that is computed on its own thread.
#pragma once

#include <functional>
#include <future>
#include <stop_token>
#include <utility>

namespace todbench {

/// Computation on its own thread. The destructor stops the computation and waits for its end. Objects to which the
/// computation refers may be destroyed afterwards.
template <typename T>
class BackgroundTask {
 public:
  /// Starts `make`. Objects that `make` refers to must outlive this object.
  explicit BackgroundTask(std::function<T(std::stop_token)> make)
      : made_(std::async(std::launch::async, std::move(make), halt_.get_token())) {}
  ~BackgroundTask() { halt_.request_stop(); }
  BackgroundTask(const BackgroundTask&) = delete;
  BackgroundTask& operator=(const BackgroundTask&) = delete;

  /// Waits for the value; a request to stop reaches the thread as well. Any thread, any number of calls; the value
  /// lives as long as this object.
  [[nodiscard]] const T& get(std::stop_token stop) {
    const std::stop_callback forward(std::move(stop), [this] { halt_.request_stop(); });
    const std::shared_future<T> made = made_;
    return made.get();
  }

 private:
  std::stop_source halt_;
  const std::shared_future<T> made_;  ///< last: its destructor waits
};

}  // namespace todbench
