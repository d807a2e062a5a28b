// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual laboratories over the wire: camera on GigE Vision, black body and stage on SCPI. Do their intervals hold the
// truth, and are they the laboratories of the same numbers on simulated frames? TODBENCH_STUDY_FOLDER: where both are
// kept, in files of their own; what is there is not made again. TODBENCH_STUDY_WIRE_RUNS: how many (30 without it).
#include <cstdio>
#include <cstdlib>

#include "tests/bench/studies/wire_laboratories.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

TEST(WireLaboratory, HoldsTheTruthAsItsBudgetSaysAndIsThatOnSimulatedFrames) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_WIRE_RUNS");
  const std::uint64_t laboratories = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 30;
  const std::string folder = kept != nullptr ? kept : temporary.path().string();
  LaboratoryRecord wire(folder + "/wire_laboratories.csv"), simulated(folder + "/wire_laboratories_simulated.csv");
  const GradedDesign design = laboratory_design();
  constexpr std::uint64_t first_seed = 20000;  // as of the laboratories on simulated frames alone
  const Plan plan = plan_of_wire_laboratories(design, first_seed);
  run_laboratories(simulated, design, plan, laboratories);
  run_laboratories(wire, design, plan, laboratories, measured_over_the_wire);
  const auto truth = true_s75_mrad(design, design.delta_t_k, 3);
  print_heading_of_summaries();
  for (const double contrast : design.delta_t_k) {
    const auto points = points_at(wire.points(), contrast);
    const LaboratorySummary s = summary_of(points, truth.at(contrast));
    print(s, contrast, drawn_bias_percent(plan, points));
    EXPECT_GT(s.coverage, 0.95 - 3 * std::sqrt(0.95 * 0.05 / s.laboratories)) << contrast;
  }
  std::printf("| contrast | laboratories | mean | its largest | rms | its largest | beyond 2 | mean | u |\n");
  for (const double contrast : design.delta_t_k) {
    const DifferenceSummary d =
        summary_of(differences_of(points_at(wire.points(), contrast), points_at(simulated.points(), contrast)));
    std::printf("| %g K | %d | %+.2f | %.2f | %.2f | %.2f | %.3f | %+.2f %% | %.2f %% |\n", contrast, d.laboratories,
                d.mean, d.largest_mean, d.rms, d.largest_rms, d.beyond_two, d.mean_percent, d.u_percent);
    EXPECT_LT(d.rms, d.largest_rms) << contrast;
    EXPECT_LT(std::abs(d.mean), d.largest_mean) << contrast;
  }
}

}  // namespace
}  // namespace todbench::testing
