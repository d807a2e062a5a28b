// SPDX-License-Identifier: GPL-3.0-or-later
// Laboratories that err as their budget says: do expanded intervals hold the truth, are the stated risks those that
// happen, do laboratories agree? TODBENCH_STUDY_FOLDER: where laboratories are kept; what is there is not made again.
// TODBENCH_STUDY_RUNS: how many (300 without it). Prints the tables of docs/validation/coverage.md.
#include <cstdio>
#include <cstdlib>

#include "tests/bench/studies/virtual_laboratories.h"
#include "tests/support/temporary_folder.h"

namespace todbench::testing {
namespace {

double standard_error(double share, double n) {
  return std::sqrt(share * (1 - share) / n);
}

TEST(VirtualLaboratory, HoldsTheTruthAsItsBudgetSays) {
  const TemporaryFolder temporary;
  const char* kept = std::getenv("TODBENCH_STUDY_FOLDER");
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t laboratories = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 300;
  LaboratoryRecord record((kept != nullptr ? kept : temporary.path().string()) + "/virtual_laboratories.csv");
  const GradedDesign design = laboratory_design();
  constexpr std::uint64_t first_seed = 20000;
  const Plan plan = plan_of_laboratories(design, first_seed);
  run_laboratories(record, design, plan, laboratories);
  const auto truth = true_s75_mrad(design, design.delta_t_k, 3);
  for (const auto& [contrast, s75_mrad] : truth) std::printf("true S75 at %g K: %.4f mrad\n", contrast, s75_mrad);
  print_heading_of_summaries();
  for (const double contrast : design.delta_t_k) {
    const auto points = points_at(record.points(), contrast);
    const LaboratorySummary s = summary_of(points, truth.at(contrast));
    print(s, contrast, drawn_bias_percent(plan, points));
    // 93 %, with three standard errors of so many.
    EXPECT_GT(s.coverage, 0.93 - 3 * standard_error(0.95, s.laboratories)) << contrast;
    EXPECT_GT(s.within_one, 0.95 - 3 * standard_error(0.95, s.pairs)) << contrast;
  }
  std::printf(
      "| contrast | rule | wrong if accepted | stated | wrong if rejected | stated | accepted on the limit |\n");
  for (const double contrast : design.delta_t_k) {
    const auto points = points_at(record.points(), contrast);
    const double reach = 4 * summary_of(points, truth.at(contrast)).u_percent / 100;
    for (const auto rule : {ConformityRule::simple, ConformityRule::guarded_acceptance_and_rejection}) {
      const RuleOutcome r = outcome_of(points, truth.at(contrast), rule, reach);
      std::printf("| %g K | %s | %.4f | %.4f | %.4f | %.4f | %.3f |\n", contrast,
                  rule == ConformityRule::simple ? "simple" : "guarded", r.wrong_if_accepted, r.stated_if_accepted,
                  r.wrong_if_rejected, r.stated_if_rejected, accepted_on_the_limit(points, truth.at(contrast)));
    }
    EXPECT_LT(accepted_on_the_limit(points, truth.at(contrast)),
              0.035 + 3 * standard_error(0.025, static_cast<double>(points.size())))
        << contrast << ": 2.5 % promised, and half of the 2 % by which a coverage may be off";
  }
}

}  // namespace
}  // namespace todbench::testing
