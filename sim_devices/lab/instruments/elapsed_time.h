// SPDX-License-Identifier: GPL-3.0-or-later
// Elapsed time of an emulated instrument.
#pragma once

#include <algorithm>
#include <chrono>

namespace todbench {

/// Returns the seconds from `from` to `to`; 0 if `to` is earlier. This occurs if another thread reads the clock later
/// but stores its time first.
[[nodiscard]] inline double seconds_between(std::chrono::steady_clock::time_point from,
                                            std::chrono::steady_clock::time_point to) {
  return std::max(0.0, std::chrono::duration<double>(to - from).count());
}

}  // namespace todbench
