// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of every shipped design with enough replicates to see one per cent. Long form of psychometric_coverage_test.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "tests/tod/psychometric/coverage_support.h"

namespace todbench {
namespace {

using testing::coverage;
using testing::Coverage;
using testing::Design;
using testing::share_error;

TEST(PsychometricCoverageStudy, BothIntervalsOfEveryDesignCoverAsPublished) {
  struct Row {
    Design design;
    Coverage expected;  // from 900 replicates of an independent implementation
  };
  const std::vector<Row> rows{{{10, 4, 4}, {0.913, 0.949}},   {{10, 8, 4}, {0.938, 0.952}},
                              {{10, 16, 2}, {0.958, 0.962}},  {{10, 16, 4}, {0.942, 0.953}},
                              {{10, 16, 10}, {0.932, 0.942}}, {{7, 30, 2}, {0.934, 0.939}},
                              {{7, 30, 4}, {0.942, 0.946}},   {{7, 30, 10}, {0.941, 0.952}}};
  constexpr int replicates = 3000, expected_replicates = 900;
  for (const Row& row : rows) {
    const Coverage ours = coverage(row.design, replicates, testing::Posteriors::count, 4);

    std::cout << row.design.sizes << " x " << row.design.trials_per_size << ", span " << row.design.span << ": profile "
              << ours.profile << " (" << row.expected.profile << "), posterior " << ours.posterior << " ("
              << row.expected.posterior << ")\n";
    const auto tolerance = [](double p) {
      return 3.5 * std::hypot(share_error(p, replicates), share_error(p, expected_replicates));
    };
    EXPECT_NEAR(ours.profile, row.expected.profile, tolerance(row.expected.profile));
    EXPECT_NEAR(ours.posterior, row.expected.posterior, tolerance(row.expected.posterior));
  }
}

TEST(PsychometricCoverageStudy, ClusteredIntervalsKeepTheirLevelFromTwelveClustersUp) {
  constexpr int replicates = 2000;
  for (const int clusters : {12, 24, 48}) {
    for (const double sd : {0.0, 0.08, 0.2}) {
      const auto result = testing::clustered_coverage({clusters, 8, 4, sd}, replicates, 5);

      std::cout << clusters << " clusters, sd " << sd << ": clustered " << result.clustered << ", naive "
                << result.naive << ", inflation " << result.mean_inflation << '\n';
      // The sandwich is biased by about -1/G of the variance beyond the factor G/(G-1): at 12 clusters this may cost
      // 0.02.
      EXPECT_GT(result.clustered, 0.95 - 3.5 * share_error(0.95, replicates) - 0.24 / clusters);
      EXPECT_LT(result.clustered, 0.99);
    }
  }
}

}  // namespace
}  // namespace todbench
