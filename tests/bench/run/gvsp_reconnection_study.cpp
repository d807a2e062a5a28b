// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement over the wire that loses its camera 24 times, in each way eight times.
#include "tests/bench/run/lost_in_mid_run.h"

namespace todbench {
namespace {

TEST(LostInMidRunStudy, ComesBackAndEveryTrialIsMadeOnATrueFrame) {
  test::expect_a_whole_run_over(24);
}

}  // namespace
}  // namespace todbench
