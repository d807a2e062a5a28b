// SPDX-License-Identifier: GPL-3.0-or-later
// 200 seeds, or TODBENCH_STUDY_RUNS: designs of least bench time on three benches, and forecast decisions. Prints the
// tables of docs/validation/coverage.md. TODBENCH_STUDY_DESIGN: this bench alone.
#include <cstdio>
#include <cstdlib>

#include "tests/bench/studies/best_designs.h"

namespace todbench::testing {
namespace {

void print_decisions_of(const TimedBench& bench, const ContrastPrediction& contrast,
                        const std::vector<DesignedRun>& runs, double truth_mrad, double count) {
  const auto expected = expected_uncertainty(contrast, nullptr);
  ASSERT_TRUE(expected);
  for (const double over : {-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0}) {
    const DecisionChances said = decision_chances(std::log1p(over / 100), *expected, {});
    const DecisionChances found = decisions_of_runs(runs, contrast.delta_t_k, truth_mrad, over);
    std::printf("| %s | %g K | %+.0f %% | %.3f | %.3f | %.3f | %.3f |\n", bench.name.c_str(), contrast.delta_t_k, over,
                said.pass, found.pass, said.fail, found.fail);
    // A camera at a limit is rarely decided wrongly: 2.5 % on each side, with three standard errors of so many runs.
    if (over != 0) continue;
    EXPECT_LE(found.pass + found.fail, 0.05 + 3 * std::sqrt(0.05 * 0.95 / count));
  }
}

TEST(BestDesign, KeepsItsHalfWidthAndCoverageOverWholeRuns) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const char* only = std::getenv("TODBENCH_STUDY_DESIGN");
  const std::uint64_t seeds = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 200;
  for (const TimedBench& bench : {default_bench(), slow_black_body(), quick_stage()}) {
    if (only != nullptr && bench.name != only) continue;
    const auto found = design_of_bench(bench);
    ASSERT_TRUE(found) << bench.name << ": " << found.error().message;
    std::printf(
        "| %s | asked %g %% | %.0f s as planned | %.0f s settled | %.0f s | %.0f s changes | %.0f s fastest | "
        "%d set-ups | %d phases | frames",
        bench.name.c_str(), bench.asked_percent, found->as_planned.bench_s, found->settled_s.value_or(NAN),
        found->best.bench_s, found->best.changes_s, found->least_s, found->set_ups, found->best.plan.target.phases);
    for (const int frames : found->best.plan.schedule.frames_per_presentation) std::printf(" %d", frames);
    std::printf(" |\n");
    DesignParts parts(bench.design);
    std::vector<DesignedRun> runs;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const auto more = run_of_design(found->best.plan, seed, parts);
      runs.insert(runs.end(), more.begin(), more.end());
    }
    const auto truth = true_s75_mrad(bench.design, bench.design.delta_t_k, 3);
    for (const ContrastPrediction& contrast : found->best.contrasts) {
      const double truth_mrad = truth.at(contrast.delta_t_k);
      const DesignSummary s = summary_of_design(runs, contrast.delta_t_k, bench.asked_percent, truth_mrad);
      std::printf(
          "| %s | %g K | %.0f runs | achieved / asked %.2f | not above %.3f | coverage %.3f | bias %+.3f %% | "
          "scatter %.3f %% | predicted %.3f %% |\n",
          bench.name.c_str(), contrast.delta_t_k, s.runs, s.ratio, s.kept, s.coverage, s.bias_percent,
          s.scatter_percent, 100 * contrast.se_ln_s75);
      std::fflush(stdout);
      const double left = 3 * std::sqrt(0.95 * 0.05 / s.runs);
      EXPECT_GE(s.kept, 0.95 - left) << bench.name << " " << contrast.delta_t_k;
      EXPECT_GE(s.coverage, 0.93 - left) << bench.name << " " << contrast.delta_t_k;
      print_decisions_of(bench, contrast, runs, truth_mrad, s.runs);
    }
  }
}

}  // namespace
}  // namespace todbench::testing
