// SPDX-License-Identifier: GPL-3.0-or-later
// Camera against twin by common phases over whole simulated runs: standard error, power, false verdicts.
// TODBENCH_STUDY_FOLDER: where runs are kept; what is there is not made again. TODBENCH_STUDY_RUNS: how many of each
// design (400 and 40 without it). Prints the tables of docs/validation/coverage.md.
#include <cstdio>
#include <cstdlib>

#include "tests/bench/studies/graded_runs.h"
#include "tests/bench/studies/paired_summary.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

struct PairedDesign {
  GradedDesign design;
  std::uint64_t runs = 40;
  bool equal = false;
};

std::vector<PairedDesign> paired_designs() {
  const auto camera = [](const std::string& name, void (*change)(SensorSpec&)) {
    PairedDesign other{.design = {.name = name}};
    change(other.design.camera);
    return other;
  };
  return {{default_design(), 400, true},
          camera("paired noise 5 % above", [](SensorSpec& s) { s.netd_k *= 1.05; }),
          camera("paired noise 20 % above", [](SensorSpec& s) { s.netd_k *= 1.2; }),
          camera("paired detector 5 % below", [](SensorSpec& s) { s.detector_um *= 0.95; })};
}

TEST(PairedComparison, OverWholeRuns) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::string folder = kept != nullptr ? kept : temporary.path().string();
  GradedRecord record(folder + "/graded_runs.csv");  // that of graded_coverage_study
  std::printf(
      "| design | contrast | pairs | true ratio | mean - true | scatter | stated | share of the twin | 95 %% | "
      "equivalent within 3 %% | at the margin | different | unpaired stated | binary stated |\n");
  for (const auto& [design, all, equal] : paired_designs()) {
    const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : all;
    DesignParts parts(design);
    for (std::uint64_t seed = 1; seed <= runs; ++seed)
      if (!record.has(design.name, seed)) record.append(results_of(parts, seed, true));
    std::map<double, double> truth{{16.9, 1}, {1.93, 1}, {0.23, 1}};
    if (!equal) {
      GradedDesign twin = design;
      twin.camera = twin.twin;
      const auto of_camera = true_s75_mrad(design, {16.9, 1.93, 0.23}, 2);
      const auto of_twin = true_s75_mrad(twin, {16.9, 1.93, 0.23}, 2);
      for (auto& [contrast, ratio] : truth) ratio = of_twin.at(contrast) / of_camera.at(contrast);
    }
    for (const double contrast : {16.9, 1.93, 0.23}) {
      const PairedSummary s = paired_summary(record.rows(), design.name, contrast, truth.at(contrast), 3);
      std::printf(
          "| %s | %g K | %d | %.4f | %+.3f %% | %.3f %% | %.3f %% | %.2f | %.3f | %.3f | %.3f | %.3f | %.2f %% | %.2f "
          "%% |\n",
          design.name.c_str(), contrast, s.runs, truth.at(contrast), s.bias_percent, s.scatter_percent,
          s.stated_percent, s.twin_share, s.coverage, s.equivalent, s.equivalent_at_margin, s.different,
          s.unpaired_percent, s.binary_percent);
      std::fflush(stdout);
      if (s.runs < 20) continue;
      EXPECT_GT(s.coverage, 0.93 - 3 * std::sqrt(0.95 * 0.05 / s.runs)) << design.name << " " << contrast;
      EXPECT_LT(s.equivalent_at_margin, 0.055 + 3 * std::sqrt(0.95 * 0.05 / s.runs)) << design.name << " " << contrast;
    }
  }
}

}  // namespace
}  // namespace todbench::testing
