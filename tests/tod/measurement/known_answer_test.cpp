// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tod/measurement/known_answer.h"

namespace todbench::test {
namespace {

TEST(KnownAnswer, OverlapsAreThoseOfTheTestPattern) {
  // A triangle and its quarter turn share sqrt(3) - 1 of their area, a triangle and its half turn a hexagon of two
  // thirds.
  EXPECT_NEAR(overlap(Apex::up, Apex::right), std::numbers::sqrt3 - 1, 1e-12);
  EXPECT_NEAR(overlap(Apex::up, Apex::left), std::numbers::sqrt3 - 1, 1e-12);
  EXPECT_NEAR(overlap(Apex::up, Apex::down), 2.0 / 3, 1e-12);
  EXPECT_NEAR(overlap(Apex::up, Apex::up), 1, 1e-12);
}

TEST(KnownAnswer, PixelsRaiseTheThresholdOfTheIdealObserverByLittle) {
  const double without = threshold_px(proportion_without_pixels, 1 / 0.3);
  const double with = threshold_px(proportion_with_pixels, 1 / 0.3);

  // d' of four orthogonal alternatives at 75 % is 1.68; these are alike: S c / q = 3.1 (fact sheet of the method,
  // section 6).
  EXPECT_NEAR(without * 0.3, 3.1, 0.05);
  EXPECT_GT(with / without, 1.02);
  EXPECT_LT(with / without, 1.25);
}

TEST(KnownAnswer, TheNinetyFivePercentIntervalContainsTheExactThreshold) {
  // A correct method has less than 12 of 16 once in 1160 contrasts. KnownAnswerStudy has 200.
  expect_intervals_hold_the_truth(16, 12);
}

}  // namespace
}  // namespace todbench::test
