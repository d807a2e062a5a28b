// SPDX-License-Identifier: GPL-3.0-or-later
// The remaining time of a phase by a clock that the test sets.
#include "bench/text/time_left.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

const TimeLeft::Time start{std::chrono::hours(5)};

TEST(TimeLeft, IsTheElapsedTimeTimesWorkLeftOverWorkDone) {
  TimeLeft left;
  left.begin(start);

  EXPECT_FALSE(left.progress(start + seconds(3), 0));
  EXPECT_DOUBLE_EQ(left.progress(start + seconds(30), 0.25).value(), 90);
  EXPECT_DOUBLE_EQ(left.progress(start + seconds(120), 1).value(), 0);
}

TEST(TimeLeft, DoesNotGrowWhileTheCameraIsAway) {
  TimeLeft left;
  left.begin(start);
  const double before = left.progress(start + seconds(60), 0.5).value();

  left.stand_still(start + seconds(60));
  left.stand_still(start + seconds(500));  // asked again: the camera has been away since the first time
  const double after = left.progress(start + seconds(60) + minutes(20), 0.5).value();

  EXPECT_DOUBLE_EQ(before, 60);
  EXPECT_DOUBLE_EQ(after, before);
}

TEST(TimeLeft, OfANewPhaseForgetsThatTheWorkStoodStill) {
  TimeLeft left;
  left.begin(start);
  left.stand_still(start + seconds(1));

  left.begin(start + seconds(100));

  EXPECT_DOUBLE_EQ(left.progress(start + seconds(110), 0.5).value(), 10);
}

TEST(TimeLeft, CallsForALineOnceAMinute) {
  TimeLeft left;
  left.begin(start);
  int lines = 0;

  for (int s = 0; s < 600; s += 7) lines += left.line_is_due(start + seconds(s)) ? 1 : 0;

  // Looked at every 7 s, a line comes every 63 s: 9 in 594 s.
  EXPECT_EQ(lines, 9);
}

}  // namespace
}  // namespace todbench
