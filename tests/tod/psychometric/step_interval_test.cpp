// SPDX-License-Identifier: GPL-3.0-or-later
// The interval of a step whose gap is narrower than the steepest function of the domain, in clustered data.
#include <gtest/gtest.h>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {
namespace {

// Three right answers at the middle size. Two clusters rule out less than independent trials: the drop that their
// interval allows is at least the square of Student's t with one degree of freedom, 161 in place of 3.84.
TEST(StepInterval, HoldsTheGapAndInClustersNoLess) {
  std::vector<Level> levels;
  for (const int cluster : {0, 1}) {
    levels.push_back({1.0, 10, 40, cluster});
    levels.push_back({1.0002, 40, 40, cluster});
  }
  levels.push_back({1.0001, 3, 3, 0});

  const auto clustered = fit_psychometric(levels, {.with_posterior = false});
  for (Level& level : levels) level.cluster = -1;
  const auto independent = fit_psychometric(levels, {.with_posterior = false});

  ASSERT_TRUE(clustered && independent);
  ASSERT_EQ(clustered->verdict, FitVerdict::step);
  ASSERT_EQ(independent->verdict, FitVerdict::step);
  ASSERT_TRUE(independent->ci95.low && independent->ci95.high);
  EXPECT_LE(*independent->ci95.low, 1.0001);
  EXPECT_GE(*independent->ci95.high, 1.0001);
  EXPECT_TRUE(!clustered->ci95.low || *clustered->ci95.low <= *independent->ci95.low);
  EXPECT_TRUE(!clustered->ci95.high || *clustered->ci95.high >= *independent->ci95.high);
}

}  // namespace
}  // namespace todbench
