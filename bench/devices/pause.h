// SPDX-License-Identifier: GPL-3.0-or-later
// A pause of a run between two presentations.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace todbench {

/// Pause switch: set by one thread, obeyed by another. Thread-safe.
class Pause {
 public:
  void pause();
  void resume();
  [[nodiscard]] bool paused() const;
  /// Returns at once if not paused; otherwise waits for at most 50 ms, less if resumed or stopped. Returns true if
  /// still paused.
  [[nodiscard]] bool rest(std::stop_token stop) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  bool paused_ = false;
};

}  // namespace todbench
