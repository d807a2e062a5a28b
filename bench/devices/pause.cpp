// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/pause.h"

#include <chrono>

namespace todbench {

void Pause::pause() {
  const std::lock_guard lock(mutex_);
  paused_ = true;
}

void Pause::resume() {
  {
    const std::lock_guard lock(mutex_);
    paused_ = false;
  }
  changed_.notify_all();
}

bool Pause::paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

bool Pause::rest(std::stop_token stop) const {
  // At 50 Hz (20 ms per frame) a camera's queue does not fill in this time.
  constexpr std::chrono::milliseconds longest{50};
  std::unique_lock lock(mutex_);
  (void)changed_.wait_for(lock, stop, longest, [this] { return !paused_; });
  return paused_;
}

}  // namespace todbench
