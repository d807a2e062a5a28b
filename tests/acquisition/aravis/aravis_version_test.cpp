// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/aravis_version.h"

#include <arv.h>
#include <gmock/gmock.h>

namespace todbench {
namespace {

TEST(RunningAravis, IsTheOneOfTheBuildOrANewerOneOfItsSeries) {
  const AravisVersion running = running_aravis();

  EXPECT_EQ(running.major, static_cast<unsigned>(ARAVIS_MAJOR_VERSION));
  EXPECT_EQ(running.minor, static_cast<unsigned>(ARAVIS_MINOR_VERSION));
  EXPECT_GE(running.micro, static_cast<unsigned>(ARAVIS_MICRO_VERSION));
}

TEST(RunningAravis, HasTheFaultsThatLaterVersionsMended) {
  EXPECT_EQ(aravis_faults({0, 8, 26}).size(), 5u);
  EXPECT_THAT(aravis_faults({0, 8, 32}), ::testing::Each(::testing::Not(::testing::HasSubstr("chunks"))));
  EXPECT_THAT(aravis_faults({0, 9, 1}), ::testing::ElementsAre(::testing::HasSubstr("Xsc Series")));
  EXPECT_THAT(aravis_faults({0, 10, 0}), ::testing::IsEmpty());
}

}  // namespace
}  // namespace todbench
