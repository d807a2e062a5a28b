// SPDX-License-Identifier: GPL-3.0-or-later
// Placement by the Psi method over many runs: efficiency and coverage, printed as the table of
// docs/validation/coverage.md.
#include <cstdio>

#include "tests/tod/schedule/psi_support.h"

namespace todbench {
namespace {

using test::least_se_ln_threshold;
using testing::psi_study;

TEST(PsiPlacementStudy, ReachesEfficiencyAndCoverage) {
  constexpr int runs = 2000;
  std::printf("| trials | slope | bias | SE | bound | efficiency | profile | posterior | half-width |\n");
  for (const double slope : {2.5, 3.5, 5.0}) {
    for (const int trials : {40, 160, 640}) {
      const auto study = psi_study({.trials = trials, .slope = slope}, runs);
      std::printf("| %d | %.1f | %+.2f %% | %.2f %% | %.2f %% | %.2f | %.3f | %.3f | %.1f %% |\n", trials, slope,
                  100 * study.bias, 100 * study.sd, 100 * least_se_ln_threshold(trials, slope), study.efficiency,
                  study.profile, study.posterior, 100 * study.half_width);
      // 2000 runs: the standard error of 0.95 is 0.005, within the limits on both sides. At 40 trials of a slope of 5
      // the prior of the slope, centred on 3.5, makes the posterior too wide.
      if (trials > 40 || slope < 5) {
        EXPECT_GE(study.posterior, 0.93) << trials << " " << slope;
        EXPECT_LE(study.posterior, 0.975) << trials << " " << slope;
      }
      if (trials < 160) continue;
      EXPECT_GE(study.efficiency, 0.75) << trials << " " << slope;
      // Adaptive placement makes the fitted slope too steep, and the profile interval too short with it: by a point and
      // a half at 3.5, by two and a half where the prior expects another slope.
      EXPECT_GE(study.profile, slope == 3.5 ? 0.93 : 0.92) << trials << " " << slope;
      EXPECT_LE(study.profile, 0.975) << trials << " " << slope;
    }
  }
}

}  // namespace
}  // namespace todbench
