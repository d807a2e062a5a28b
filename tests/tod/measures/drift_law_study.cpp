// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the law of drift over 200 seeds: the figures of docs/validation/physical-measures.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tod/measures/drift_coverage.h"

namespace todbench {
namespace {

TEST(DriftLawStudy, HoldsTheDriftOfLevelAndPattern) {
  const testing::DriftCase cases[] = {{},
                                      {.level_k = 0.03, .pattern_k = 0.005},
                                      {.level_k = 0, .pattern_k = 0},
                                      {.frame_noise_k = 0},
                                      {.time_constant_s = 5.0},
                                      {.time_constant_s = 15.0},
                                      {.level_k = 0.05, .pattern_k = 0.01, .time_constant_s = 10.0}};
  for (const testing::DriftCase& drift : cases) {
    const auto found = testing::drift_coverage(drift, 200);
    fmt::print(
        "level {} K, pattern {} K, noise {} K, time constant {}: level {:.3f} ({:+.5f} +-{:.5f}) pattern {:.3f} "
        "({:+.5f} "
        "+-{:.5f}), approaches {} and {}, time constant within {:.3f}\n",
        drift.level_k, drift.pattern_k, drift.frame_noise_k, drift.time_constant_s.value_or(0), found.level_within,
        found.level_error_k, found.level_half_k, found.pattern_within, found.pattern_error_k, found.pattern_half_k,
        found.level_approaches, found.pattern_approaches, found.constant_within);
    // 200 seeds: standard error 0.015.
    EXPECT_GT(found.level_within, 0.95 - 3 * 0.015);
    EXPECT_GT(found.pattern_within, 0.95 - 3 * 0.015);
  }
}

}  // namespace
}  // namespace todbench
