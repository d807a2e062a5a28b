// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/repeat_cadence.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

TEST(RepeatCadence, IsLearntFromEightExposuresThatAreSentTwiceOrThrice) {
  for (const int times : {2, 3}) {
    RepeatCadence cadence;
    for (int exposure = 0; exposure < 20; ++exposure) {
      for (int copy = 0; copy < times; ++copy) cadence.see(copy > 0);
    }
    EXPECT_EQ(cadence.times(), times);
    EXPECT_EQ(cadence.repeats(), 20u * static_cast<unsigned>(times - 1));
    EXPECT_TRUE(cadence.in_rhythm());
    cadence.see(true);
    EXPECT_FALSE(cadence.in_rhythm());
  }
}

TEST(RepeatCadence, IsNoneOfACameraThatIsStuckOrClosesItsShutterNowAndThen) {
  RepeatCadence stuck, shutter;
  for (int frame = 0; frame < 1000; ++frame) {
    stuck.see(frame > 0);
    shutter.see(frame % 100 > 90);
  }
  EXPECT_EQ(stuck.times(), 1);
  EXPECT_EQ(shutter.times(), 1);
  EXPECT_EQ(shutter.sentence(), "");
}

}  // namespace
}  // namespace todbench
