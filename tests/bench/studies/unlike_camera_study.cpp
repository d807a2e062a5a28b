// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the truth by sessions of cameras that are not as their twins are stated. TODBENCH_STUDY_FOLDER: where
// runs are kept; what is there is not made again. TODBENCH_STUDY_RUNS: how many of each design (200 without it).
// TODBENCH_STUDY_DESIGN: this one alone. TODBENCH_STUDY_SHARE: "1/2", every second run, for two processes at once,
// without figures.
#include <cstdio>
#include <cstdlib>

#include "tests/bench/studies/unlike_cameras.h"

namespace todbench::testing {
namespace {

TEST(UnlikeCameras, HoldTheTruthAsOftenAsTheySay) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const char* only = std::getenv("TODBENCH_STUDY_DESIGN");
  const std::string folder = kept != nullptr ? kept : temporary.path().string();
  const std::uint64_t runs = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 200;
  const StudyShare share = study_share();
  GradedRecord record(folder + "/unlike_cameras.csv", share);
  for (const GradedDesign& design : unlike_designs()) {
    if (only != nullptr && design.name != only) continue;
    for (std::uint64_t seed = share.first; seed <= runs; seed += share.step)
      if (!record.has(design.name, seed)) record.append(unlike_results(design, seed));
  }
  if (share.step > 1) return;
  std::printf("| design | contrast | what | runs | bias | half-width | held | error of the truth |\n");
  for (const GradedDesign& design : unlike_designs()) {
    if (only != nullptr && design.name != only) continue;
    for (const double contrast : design.delta_t_k) {
      const DirectTruth camera = truth_of(camera_of(design), contrast, 3), twin = truth_of(design.twin, contrast, 3);
      for (const char* what : {"fit", "paired"}) {
        const bool ratio = std::string(what) == "paired";
        const GradedSummary s = summary_of(record.rows(), design.name, contrast, what,
                                           ratio ? twin.s75_mrad / camera.s75_mrad : camera.s75_mrad);
        std::printf("| %s | %g K | %s | %d | %+.2f %% | %.2f %% | %.0f | %.2f %% |\n", design.name.c_str(), contrast,
                    what, s.runs, s.bias_percent, s.half_width_percent, s.coverage * s.runs,
                    ratio ? std::hypot(camera.se_percent, twin.se_percent) : camera.se_percent);
        std::fflush(stdout);
        // 93 %, with three standard errors of so many runs.
        if (s.runs < 2) continue;
        EXPECT_GT(s.coverage, 0.93 - 3 * std::sqrt(0.95 * 0.05 / s.runs)) << design.name << contrast;
      }
    }
  }
}

}  // namespace
}  // namespace todbench::testing
