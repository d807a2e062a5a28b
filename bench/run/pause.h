// A run that rests between two presentations.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>

namespace todbench {

/// Switched by one thread, obeyed by another. Thread-safe.
class Pause {
 public:
  void pause();
  void resume();
  [[nodiscard]] bool paused() const;
  /// Returns at once when not paused; otherwise rests up to a twentieth of a second, less when resumed or stopped.
  /// True: still paused.
  [[nodiscard]] bool rest(std::stop_token stop) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable_any changed_;
  bool paused_ = false;
};

}  // namespace todbench
