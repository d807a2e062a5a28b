// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/patience.h"

#include <algorithm>
#include <cstdlib>
#include <thread>

namespace todbench::testing_support {

std::chrono::milliseconds patience(std::chrono::milliseconds idle) {
  double load = 0;
  if (::getloadavg(&load, 1) != 1) return idle;
  const double programs_per_processor = load / std::max(1U, std::thread::hardware_concurrency());
  // The average is that of a minute: right after a burst it still says too little, hence twice.
  return std::chrono::duration_cast<std::chrono::milliseconds>(idle * std::max(1.0, 2 * programs_per_processor));
}

}  // namespace todbench::testing_support
