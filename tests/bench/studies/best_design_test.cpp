// SPDX-License-Identifier: GPL-3.0-or-later
// Short form of best_design_study.
#include "tests/bench/studies/best_designs.h"

namespace todbench::testing {
namespace {

TEST(BestDesign, KeepsItsHalfWidthInThreeRuns) {
  TimedBench bench = default_bench();
  bench.asked_percent = 6;  // few frames: seconds
  bench.design.delta_t_k = {1.93, 0.23};
  bench.design.frames = {4};  // one number for both contrasts, for the functions and the truth
  const auto found = design_of_bench(bench);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_GE(found->set_ups, 5);
  DesignParts parts(bench.design);
  std::vector<DesignedRun> runs;
  for (std::uint64_t seed = 901; seed <= 903; ++seed) {
    const auto more = run_of_design(found->best.plan, seed, parts);
    runs.insert(runs.end(), more.begin(), more.end());
  }

  const auto truth = true_s75_mrad(bench.design, {0.23}, 1);
  const DesignSummary s = summary_of_design(runs, 0.23, bench.asked_percent, truth.at(0.23));

  ASSERT_EQ(s.runs, 3);
  EXPECT_GE(s.kept, 0.6) << "two of three: fewer has a probability of 0.7 % at 95 %";
  EXPECT_GE(s.coverage, 0.6);
  const auto contrast = std::ranges::find(found->best.contrasts, 0.23, &ContrastPrediction::delta_t_k);
  ASSERT_NE(contrast, found->best.contrasts.end());
  EXPECT_LT(std::abs(s.bias_percent), 4 * 100 * contrast->se_ln_s75 / std::sqrt(3.0));
}

}  // namespace
}  // namespace todbench::testing
