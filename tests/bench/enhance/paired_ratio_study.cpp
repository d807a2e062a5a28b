// SPDX-License-Identifier: GPL-3.0-or-later
// How often the paired interval of `enhance` holds the true ratio, over designs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/bench/enhance/paired_ratio_coverage.h"

namespace todbench {
namespace {

TEST(PairedRatioStudy, HoldsTheTrueRatioAsOftenAsItSays) {
  constexpr int runs = 400;
  std::uint64_t seed = 100;
  for (const int presentations : {12, 24, 48}) {
    for (const double presentation_sd : {0.0, 0.1}) {
      const auto found =
          testing::coverage_of({.presentations = presentations, .presentation_sd = presentation_sd}, runs, ++seed);
      std::printf("%2d presentations, sd %.1f: %d of %d intervals hold the ratio (%.1f %%), half width %.3f\n",
                  presentations, presentation_sd, found.holding, found.intervals,
                  100.0 * found.holding / found.intervals, found.mean_half_width);
      EXPECT_GE(found.intervals, runs * 95 / 100);
      // 95 % within four standard errors of so many, and 2 % for what the jackknife is off with few groups.
      EXPECT_NEAR(static_cast<double>(found.holding) / found.intervals, 0.95,
                  0.02 + 4 * std::sqrt(0.95 * 0.05 / found.intervals))
          << presentations << " " << presentation_sd;
    }
  }
}

}  // namespace
}  // namespace todbench
