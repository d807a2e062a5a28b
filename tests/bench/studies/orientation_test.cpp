// SPDX-License-Identifier: GPL-3.0-or-later
// Thresholds by the direction of the triangles: alike for a camera without noise of rows or columns, apart with it.
#include "tod/adequacy/orientation.h"

#include <cstdio>

#include "tests/bench/studies/graded_runs.h"

namespace todbench::testing {
namespace {

struct OrientationRuns {
  int runs = 0, findings = 0, within = 0;
  double mean_percent = 0, mean_se_percent = 0;
};

/// Runs of a camera at 0.5 K, with the function of a plain twin.
OrientationRuns orientation_runs(const SensorSpec& camera, std::uint64_t first, int count) {
  const GradedDesign design{.name = "orientation", .camera = camera, .twin = {}, .phases = 3, .delta_t_k = {0.5}};
  DesignParts parts(design);
  OrientationRuns out;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    const Plan plan = plan_of(design, seed);
    const std::vector<Trial> trials = trials_of(plan, inputs_of(plan, camera), parts);
    const auto tables = twin_tables(plan, inputs_of(plan, design.twin), std::nullopt, {}).value();
    const auto found = orientations(trials, tables.begin()->second);
    if (!found) {
      ADD_FAILURE() << "no comparison of the directions";
      continue;
    }
    EXPECT_EQ(found->set_ups, 8);
    ++out.runs;
    out.findings += orientation_finding(*found) ? 1 : 0;
    out.within += std::abs(found->axes_percent) < 2.365 * found->axes_se_percent ? 1 : 0;
    out.mean_percent += found->axes_percent / count, out.mean_se_percent += found->axes_se_percent / count;
  }
  std::printf("%d runs: %d findings, %d within the 95 %% interval of 0, mean %+.2f +- %.2f %%\n", out.runs,
              out.findings, out.within, out.mean_percent, out.mean_se_percent);
  return out;
}

// TODBENCH_STUDY_RUNS: runs of each camera (6 without it).
TEST(Orientation, OfTheTrianglesMattersOnlyWithNoiseOfRowsOrColumns) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const int runs = asked != nullptr ? std::atoi(asked) : 4;
  SensorSpec rows;
  rows.row_noise_k = 0.3;

  const OrientationRuns plain = orientation_runs({}, 1, runs), noisy = orientation_runs(rows, 501, runs);

  // At 0.3 % each: two findings of four come by chance once in 18000.
  EXPECT_LE(plain.findings, 1 + runs / 100);
  // 95 % intervals: three of four or more miss 0 by chance once in 2000.
  EXPECT_GE(plain.within, runs - 2 - runs / 10);
  EXPECT_GE(noisy.findings, runs / 2);
  EXPECT_LT(noisy.mean_percent, -5);
}

}  // namespace
}  // namespace todbench::testing
