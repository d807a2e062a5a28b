// SPDX-License-Identifier: GPL-3.0-or-later
// A 95 % interval must contain the truth in 95 % of experiments: short form of the coverage study.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tod/psychometric/coverage_support.h"

namespace todbench {
namespace {

using testing::ClusteredCoverage;
using testing::ClusteredDesign;
using testing::coverage;
using testing::Design;
using testing::Posteriors;
using testing::share_error;

TEST(PsychometricCoverage, ProfileIntervalsOfShippedDesignsCoverAsPublished) {
  struct Row {
    Design design;
    double expected;  // from 900 replicates of an independent implementation
  };
  constexpr int replicates = 400, expected_replicates = 900;
  for (const Row& row : {Row{{10, 4, 4}, 0.913}, Row{{10, 16, 2}, 0.958}, Row{{10, 16, 4}, 0.942}}) {
    const double profile = coverage(row.design, replicates, Posteriors::skip, 1).profile;

    // 3.5 standard errors of the difference: one false alarm in 2000 for another seed.
    const double tolerance =
        3.5 * std::hypot(share_error(row.expected, replicates), share_error(row.expected, expected_replicates));
    EXPECT_NEAR(profile, row.expected, tolerance) << row.design.sizes << " x " << row.design.trials_per_size;
  }
}

TEST(PsychometricCoverage, ClusteredIntervalsKeepTheirLevelWhereIndependentOnesLoseIt) {
  constexpr int replicates = 300;

  const ClusteredCoverage result = testing::clustered_coverage({}, replicates, 2);

  // 3.5 standard errors of 0.95 at 300 replicates is 0.044; the sandwich with 24 clusters may lose another 0.01.
  EXPECT_GT(result.clustered, 0.95 - 3.5 * share_error(0.95, replicates) - 0.01);
  EXPECT_LT(result.clustered, 0.95 + 3.5 * share_error(0.95, replicates));
  EXPECT_LT(result.naive, 0.85);
  EXPECT_GT(result.mean_inflation, 1.5);
}

TEST(PsychometricCoverage, ClustersWithoutEffectInflateLittle) {
  ClusteredDesign independent;
  independent.cluster_sd = 0;
  constexpr int replicates = 300;

  const ClusteredCoverage result = testing::clustered_coverage(independent, replicates, 3);

  // The ratio of variances has a standard deviation of about sqrt(2 / 23) = 0.29 with 24 clusters; cut at 1 its mean is
  // 1 + 0.29 x 0.4.
  EXPECT_LT(result.mean_inflation, 1.2);
  EXPECT_GT(result.clustered, 0.95 - 3.5 * share_error(0.95, replicates));
}

}  // namespace
}  // namespace todbench
