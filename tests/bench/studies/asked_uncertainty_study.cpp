// 200 seeds: what a plan asks or predicts against what its runs achieve. Prints the table of docs/uncertainty.md.
#include <algorithm>
#include <cstdio>

#include "tests/bench/studies/asked_uncertainty.h"
#include "tod/comparison/planning.h"

namespace todbench::testing {
namespace {

constexpr std::uint64_t seeds = 200;

/// Asked 0: what the plan predicted.
void print_and_expect(const char* what, double delta_t_k, const std::vector<AskedAndAchieved>& runs,
                      double asked_percent) {
  double mean = 0, largest = 0, kept = 0, count = 0;
  for (const AskedAndAchieved& run : runs) {
    if (run.delta_t_k != delta_t_k) continue;
    const double asked = asked_percent > 0 ? asked_percent : run.predicted_percent;
    mean += run.achieved_percent / asked;
    largest = std::max(largest, run.achieved_percent / asked);
    kept += run.achieved_percent <= asked ? 1 : 0;
    ++count;
  }
  std::printf("| %s | %g K | %.0f | %.2f | %.2f | %.3f |\n", what, delta_t_k, count, mean / count, largest,
              kept / count);
  std::fflush(stdout);
  EXPECT_EQ(count, static_cast<double>(seeds));
  EXPECT_GE(kept / count, 0.95) << what << " " << delta_t_k;
}

/// Curves of one truth in pairs: how often each contrast is found equivalent, against the power that was predicted from
/// uncertainties which most runs do not reach.
void expect_power(const std::vector<TodCurve>& curves, const std::vector<AskedAndAchieved>& runs) {
  for (const double margin_percent : {7.0, 10.0}) {
    for (std::size_t contrast = 0; contrast < 2; ++contrast) {
      int found = 0;
      const int pairs = static_cast<int>(curves.size() / 2);
      for (std::size_t i = 0; i + 1 < curves.size(); i += 2) {
        const auto comparison = compare(curves[i], curves[i + 1], {.margin_percent = margin_percent, .fit = {}});
        ASSERT_TRUE(comparison);
        found += comparison->points[contrast].verdict == ComparisonVerdict::equivalent ? 1 : 0;
      }
      const double se = runs[contrast].predicted_percent / 196;
      const double promised = equivalence_power(std::sqrt(2.0) * se, margin_percent, 0);
      const double share = found / static_cast<double>(pairs);
      std::printf("| equivalent within %g %% | %g K | %d pairs | promised %.2f | found %.2f |\n", margin_percent,
                  runs[contrast].delta_t_k, pairs, promised, share);
      EXPECT_GE(share, promised - 3.5 * std::sqrt(promised * (1 - promised) / pairs)) << margin_percent;
    }
  }
  std::fflush(stdout);
}

TEST(AskedUncertainty, IsNotExceededInNineteenOfTwentyRuns) {
  std::printf("| design | contrast | runs | mean achieved / asked | largest | share not above |\n");
  for (const auto& [kind, asked] : {std::pair(ScheduleKind::constant, 0.0), std::pair(ScheduleKind::adaptive, 8.0)}) {
    std::vector<AskedAndAchieved> runs;
    std::vector<TodCurve> curves;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      auto found = run_of(plan_to_study(kind, 8, EstimatorChoice::weibull), seed);
      runs.insert(runs.end(), found.contrasts.begin(), found.contrasts.end());
      curves.push_back(std::move(found.curve));
    }
    const char* what = kind == ScheduleKind::constant ? "constant, against the prediction" : "adaptive, 8 % asked";
    for (const double delta_t_k : {1.93, 0.23}) print_and_expect(what, delta_t_k, runs, asked);
    if (kind == ScheduleKind::constant) expect_power(curves, runs);
  }
}

/// The direct estimate: asked is a tolerance, and what counts is the distance from the truth.
TEST(AskedUncertainty, ToleranceOfTheDirectEstimateIsKeptInNineteenOfTwentyRuns) {
  const SensorSpec sensor;
  const SensorPlan plan = full_plan(sensor, {}, {});
  TemplateObserver observer({}, triangle_alternatives());
  std::printf("| tolerance | contrast | runs | rms error | 1.96 standard errors | share within |\n");
  for (const double delta_t_k : {16.9, 0.23}) {
    const double truth = true_s75_pitch(sensor, plan, observer, delta_t_k);
    for (const double tolerance : {1.0, 2.0, 5.0}) {
      const auto kept = errors_of_direct_estimates(sensor, plan, observer, delta_t_k, tolerance, truth, seeds);
      std::printf("| %g %% | %g K | %d | %.2f %% | %.2f %% | %.3f |\n", tolerance, delta_t_k, static_cast<int>(seeds),
                  kept.rms_percent, kept.stated_percent, kept.share);
      std::fflush(stdout);
      EXPECT_GE(kept.share, 0.95) << tolerance << " " << delta_t_k;
    }
  }
}

}  // namespace
}  // namespace todbench::testing
