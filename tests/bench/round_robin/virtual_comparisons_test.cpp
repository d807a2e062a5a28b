// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of virtual_comparisons_study.
#include "tests/bench/round_robin/virtual_comparisons.h"

#include <gtest/gtest.h>

namespace todbench::testing {
namespace {

TEST(VirtualComparisons, OfHonestLaboratoriesHoldTheTruthAndNameFew) {
  const VirtualSummary s = summary_of({.comparisons = 60, .seed = 11});

  // Three standard errors of 180 items at 95 %: 4.9 %. Of 60 comparisons at 2.5 %, more than six have p = 0.04 %.
  EXPECT_GE(s.held, 0.95 - 0.049);
  EXPECT_LE(s.false_alarm, 0.1);
  // 1440 correct results exceed |E_n| = 1 with 4.6 %; correlated within an item, so five standard errors.
  EXPECT_NEAR(s.e_n_above, 0.0455, 5 * std::sqrt(0.0455 * 0.9545 / 1440));
}

TEST(VirtualComparisons, WithABiasOfThreeUncertaintiesNameTheLaboratory) {
  const VirtualSummary s = summary_of({.comparisons = 60, .bias_u = 3, .seed = 12});

  // Three standard errors of 60 at 95 %: 8.4 %.
  EXPECT_GE(s.found, 0.95 - 0.084);
  EXPECT_GE(s.held, 0.95 - 0.049);
  EXPECT_LE(s.false_alarm, 0.1);
}

}  // namespace
}  // namespace todbench::testing
