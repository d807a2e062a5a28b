// SPDX-License-Identifier: GPL-3.0-or-later
// Scans that are right, and scans that the frames contradict.
#include <gmock/gmock.h>

#include "tests/tod/measurement/scans.h"

namespace todbench::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ScanWatch, AcceptsARightScanBehindAFixedPattern) {
  for (const double contrast_k : {16.9, 0.5}) {
    for (const std::uint64_t seed : {901, 902}) EXPECT_THAT(refusal_of({.contrast_k = contrast_k}, seed), IsEmpty());
  }
}

TEST(ScanWatch, RefusesFramesAtRest) {
  EXPECT_THAT(refusal_of({.moves = 0, .set_ups = 1}, 1), HasSubstr("do not follow the scan"));
  EXPECT_THAT(refusal_of({.moves = 0, .contrast_k = 0.5}, 1), HasSubstr("do not follow the scan"));
}

TEST(ScanWatch, RefusesAScanOfHalfTheStepOrTheWrongSign) {
  EXPECT_THAT(refusal_of({.moves = 0.5, .set_ups = 1}, 1), HasSubstr("moves the picture by (0.5"));
  EXPECT_THAT(refusal_of({.moves = 0.5, .contrast_k = 0.5}, 1), HasSubstr("do not follow the scan"));
  EXPECT_THAT(refusal_of({.moves = -1, .set_ups = 1}, 1), HasSubstr("moves the picture by (-1.0"));
}

TEST(ScanWatch, LooksAtFramesOfAScanOnly) {
  ScanFrames frames;
  frames.add(Frame{}, cv::Mat1d(4, 4, 1.0));
  EXPECT_TRUE(frames.places().empty());
  ScanWatch watch;
  EXPECT_TRUE(watch.look(frames, {}, {}, {}));
}

}  // namespace
}  // namespace todbench::test
