// SPDX-License-Identifier: GPL-3.0-or-later
// All reasons of the integrity gate mixed, at three rates.
#include "tests/tod/measurement/fault_matrix.h"

namespace todbench {
namespace {

using test::FaultMatrix;

std::vector<Rejection> every_reason() {
  return {std::begin(all_rejections), std::end(all_rejections)};
}

TEST_F(FaultMatrix, EveryReasonTogetherAtATenthOfAPercentLeavesTheAnswersAsTheyWere) {
  expect_same_answers({.faults = every_reason(), .share = 0.001, .first = 5});
}

TEST_F(FaultMatrix, EveryReasonTogetherAtOnePercentLeavesTheAnswersAsTheyWere) {
  expect_same_answers({.faults = every_reason(), .share = 0.01, .first = 5, .seed = 2});
}

TEST_F(FaultMatrix, EveryReasonTogetherAtFivePercentLeavesTheAnswersAsTheyWere) {
  expect_same_answers({.faults = every_reason(), .share = 0.05, .first = 5, .seed = 3});
}

TEST_F(FaultMatrix, EveryReasonTogetherAtFivePercentLeavesGradedAnswersAsTheyWere) {
  grade_answers(3);

  expect_same_answers({.faults = every_reason(), .share = 0.05, .first = 5, .seed = 4});
}

}  // namespace
}  // namespace todbench
