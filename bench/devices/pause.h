// SPDX-License-Identifier: GPL-3.0-or-later
// Pause of a run between two presentations.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace todbench {

/// Pause switch: one thread sets the switch, and a second thread waits while it is set. Thread-safe.
class Pause {
 public:
  /// Requests a pause.
  void pause();
  /// Ends the pause.
  void resume();
  /// Returns whether a pause is requested.
  [[nodiscard]] bool paused() const;
  /// Returns immediately if not paused; otherwise waits for at most 50 ms, or until resumed or stopped. Returns true if
  /// still paused.
  [[nodiscard]] bool rest(std::stop_token stop) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  bool paused_ = false;
};

}  // namespace todbench
