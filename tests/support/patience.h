// SPDX-License-Identifier: GPL-3.0-or-later
// How long a test waits for something before it has failed.
#pragma once

#include <chrono>

namespace todbench::testing_support {

/// `idle`, a generous multiple of what an idle machine takes, times the number of runnable programs for each processor
/// while there are more than one: a busy machine is slow, not wrong. The load changes while a test waits, so ask again
/// at each look at the clock.
[[nodiscard]] std::chrono::milliseconds patience(std::chrono::milliseconds idle);

}  // namespace todbench::testing_support
