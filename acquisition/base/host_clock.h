// SPDX-License-Identifier: GPL-3.0-or-later
// The clock of the host.
#pragma once

#include <chrono>
#include <cstdint>

namespace todbench {

/// Returns CLOCK_MONOTONIC in nanoseconds, the clock of Frame::host_time_ns. Thread-safe.
[[nodiscard]] inline std::int64_t monotonic_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace todbench
