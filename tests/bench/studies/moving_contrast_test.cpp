// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/bench/studies/moving_contrasts.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

/// S75 of the plain sensor in mrad by contrast: direct estimates without trials, at reference accuracy, over six seeds
/// (moving_contrast_study prints them). Their standard errors are 0.03 to 0.06 %.
const std::map<double, double> truth_mrad{{0.23, 3.43763}, {0.3, 3.04172}, {0.5, 2.56331}, {1.2, 2.20375},
                                          {1.93, 2.13759}, {3.5, 2.10492}, {10, 2.09153},  {16.9, 2.09028}};

/// The short form of moving_contrast_study: the error of one run stays within four standard errors, by its half-width
/// (twice a standard deviation), and 0.3 % for the truth.
void expect_truth(const testing::MovingContrasts& design) {
  constexpr int runs = 1;

  const testing::TemporaryFolder folder;
  testing::MovingRecord record(folder.path() / "runs.csv");
  const auto summary = testing::study_of(design, 100, runs, record, [](double delta_t_k) {
    return testing::MovingTruth{.ln_s75 = std::log(truth_mrad.at(delta_t_k))};
  });

  ASSERT_EQ(summary.size(), design.judged_k.size()) << design.name;
  for (const auto& one : summary) {
    EXPECT_LT(std::abs(one.bias_percent), 2 * one.half_percent + 0.3) << design.name << " " << one.delta_t_k;
    EXPECT_LT(one.half_percent, 8) << design.name << " " << one.delta_t_k;
  }
}

TEST(MovingContrasts, WithinABandTheThresholdIsThatAtTheSetContrast) {
  expect_truth(testing::moving_designs().front());
}

TEST(MovingContrasts, ALagThatThePlanDoesNotStateIsFound) {
  testing::MovingContrasts design{.name = "lag", .lag_s = 0.1, .stated_lag_s = 0.03};
  testing::Surfaces surfaces;
  std::vector<AdequacyFinding> findings;

  (void)testing::moving_run(design, 100, surfaces, &findings);

  // The black body of 2.2 s changes by up to a share of 0.45 in a second: small triangles differ by up to 4.5 %.
  const auto lag = std::ranges::find(findings, FindingKind::contrast_lag, &AdequacyFinding::kind);
  ASSERT_NE(lag, findings.end());
  EXPECT_NEAR(*lag->value, 0.1, 0.03) << lag->sentence;
  EXPECT_TRUE(lag->unfit);
}

TEST(MovingContrasts, ARampHoldsTheCurveAtContrastsThatThePlanDoesNotName) {
  expect_truth(testing::moving_designs()[1]);
}

}  // namespace
}  // namespace todbench
