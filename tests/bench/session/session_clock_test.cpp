// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/session/session_clock.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

using std::chrono::nanoseconds;
using std::chrono::seconds;

/// Clocks that a test sets.
struct FakeClocks {
  HostClocks::Wall wall{seconds(1769862896)};  // 2026-01-31T12:34:56Z
  nanoseconds monotonic{7};

  [[nodiscard]] HostClocks clocks() {
    return {.wall = [this] { return wall; }, .monotonic = [this] { return monotonic; }};
  }
  void pass(seconds time) {
    wall += time;
    monotonic += time;
  }
};

TEST(SessionClock, TellsTheStartAndWhatPassed) {
  FakeClocks host;
  const SessionClock clock(host.clocks());

  host.pass(seconds(5400));

  EXPECT_EQ(clock.started_utc(), "2026-01-31T12:34:56Z");
  EXPECT_EQ(clock.now_utc(), "2026-01-31T14:04:56Z");
  EXPECT_EQ(clock.passed_s(), 5400);
  EXPECT_EQ(clock.jump_s(), 0);
}

TEST(SessionClock, IsNotMovedByAClockThatIsSet) {
  for (const seconds jump : {seconds(86400), seconds(-86400), seconds(20)}) {
    FakeClocks host;
    const SessionClock clock(host.clocks());
    host.pass(seconds(10));

    host.wall += jump;

    EXPECT_EQ(clock.now_utc(), "2026-01-31T12:35:06Z");
    EXPECT_EQ(clock.jump_s(), static_cast<double>(jump.count()));
  }
}

TEST(SessionClock, TakesSlewingForNoJump) {
  FakeClocks host;
  const SessionClock clock(host.clocks());
  host.pass(seconds(10000));

  // NTP slews by at most 0.05 %: 5 s of 10000 s; the limit is 1 s and 0.1 %.
  host.wall += seconds(5);
  EXPECT_EQ(clock.jump_s(), 0);
  host.wall += seconds(7);
  EXPECT_EQ(clock.jump_s(), 12);
}

}  // namespace
}  // namespace todbench
