// SPDX-License-Identifier: GPL-3.0-or-later
// Test programs whose cases run against real time.
#pragma once

namespace todbench::testing_support {

/// RUN_ALL_TESTS() beside a clock that ticks every 5 ms. An emulated camera does not wait: where the whole machine
/// stands still for longer than its buffers last, frames are lost in truth, and a case that counts them says so. Such a
/// case shows nothing, so it is run again, at most three times: a case that failed and during which a tick came more
/// than 10 ms late (a frame at 100 Hz). A case that failed while the clock was right stays failed. `argv` is that of
/// main().
int run_timed_tests(char** argv);

}  // namespace todbench::testing_support
