// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tod/measurement/known_answer.h"

namespace todbench::test {
namespace {

TEST(KnownAnswerStudy, TheNinetyFivePercentIntervalContainsTheExactThreshold) {
  // A correct method has 190 +- 3.1 of 200, and less than 180 once in 860 contrasts.
  expect_intervals_hold_the_truth(200, 180);
}

}  // namespace
}  // namespace todbench::test
