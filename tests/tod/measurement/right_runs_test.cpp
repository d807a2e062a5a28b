// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of right_runs_study.
#include "tests/tod/measurement/right_runs.h"

namespace todbench::test {
namespace {

TEST(RightRuns, HaveNoFalseAlarm) {
  for (const RightCamera& camera : right_cameras()) {
    const FalseAlarms found = right_runs(camera, 901, 2);
    EXPECT_EQ(found.runs, 2);
    EXPECT_EQ(found.all(), FalseAlarms{}.all()) << camera.name;
  }
}

}  // namespace
}  // namespace todbench::test
