// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of unlike_camera_study.
#include <algorithm>

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

/// The function at the twin's noise leaves +1.6 % here, and frees the slope.
TEST(UnlikeCameras, WithTwiceTheNoiseOfTheTwinHaveTheirOwnFunction) {
  const std::vector<GradedDesign> designs = unlike_designs();
  const auto noisy = std::ranges::find(designs, "NETD x 2", &GradedDesign::name);
  ASSERT_NE(noisy, designs.end());

  const std::vector<GradedResult> rows = unlike_results(*noisy, 923);

  const double truth = truth_of(camera_of(*noisy), 0.5, 1).s75_mrad;
  const GradedSummary s = summary_of(rows, noisy->name, 0.5, "fit", truth);
  ASSERT_EQ(s.runs, 1);
  EXPECT_LT(std::abs(s.bias_percent), 3 * s.half_width_percent / 1.96);
  for (const GradedResult& row : rows) {
    if (row.estimator == "fit") {
      EXPECT_EQ(row.slope_fitted, 0) << row.delta_t_k;
    }
  }
}

}  // namespace
}  // namespace todbench::testing
