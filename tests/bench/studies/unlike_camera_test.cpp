// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of unlike_camera_study.
#include "tests/bench/studies/unlike_cameras.h"

namespace todbench::testing {
namespace {

/// The function of the twin, and contrasts divided by its response, leave -0.46 % here, nearly a whole half-width.
TEST(UnlikeCameras, WithMoreBlurThanTheTwinHaveTheirOwnThreshold) {
  GradedDesign design = unlike_designs()[1];
  design.phases = 3;
  const double truth = truth_of(camera_of(design), 16.9, 1).s75_mrad;
  std::vector<GradedResult> rows;
  for (const std::uint64_t seed : {921, 922})
    for (const GradedResult& row : unlike_results(design, seed)) rows.push_back(row);

  const GradedSummary s = summary_of(rows, design.name, 16.9, "fit", truth);

  ASSERT_EQ(s.runs, 2);
  // Three standard errors of two sessions, and 0.3 % of the truth.
  EXPECT_LT(std::abs(s.bias_percent), 3 * s.half_width_percent / 1.96 / std::sqrt(2.0) + 0.3);
  EXPECT_GE(s.coverage, 0.5) << "both miss with a probability of 0.25 %";
}

}  // namespace
}  // namespace todbench::testing
