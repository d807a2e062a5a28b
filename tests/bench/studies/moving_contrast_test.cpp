// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/bench/studies/moving_contrasts.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

/// Two runs: the mean error stays within four standard errors of a mean of two, by the half-widths of the runs (twice a
/// standard deviation each), and 0.3 % for the truth.
void expect_truth(const testing::MovingContrasts& design) {
  constexpr int runs = 2;

  const testing::TemporaryFolder folder;
  testing::MovingRecord record(folder.path() / "runs.csv");
  const auto summary = testing::study_of(design, 100, runs, record);

  ASSERT_EQ(summary.size(), design.judged_k.size()) << design.name;
  for (const auto& one : summary) {
    EXPECT_LT(std::abs(one.bias_percent), 4 * one.half_percent / 2 / std::sqrt(static_cast<double>(runs)) + 0.3)
        << design.name << " " << one.delta_t_k;
    EXPECT_LT(one.half_percent, 8) << design.name << " " << one.delta_t_k;
  }
}

TEST(MovingContrasts, WithinABandTheThresholdIsThatAtTheSetContrast) {
  expect_truth(testing::moving_designs().front());
}

TEST(MovingContrasts, ARampHoldsTheCurveAtContrastsThatThePlanDoesNotName) {
  expect_truth(testing::moving_designs()[1]);
}

}  // namespace
}  // namespace todbench
