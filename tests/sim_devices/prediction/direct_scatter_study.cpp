// SPDX-License-Identifier: GPL-3.0-or-later
// Scatter of direct estimates over seeds against the standard errors that they state. TODBENCH_STUDY_RUNS: seeds of
// each level (200 without it). Prints the table of docs/validation/coverage.md.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/sim_devices/prediction/direct_scatter.h"
#include "tests/sim_devices/reference.h"

namespace todbench::testing {
namespace {

Accuracy asked(double standard_error_percent) {
  return Accuracy::for_tolerance(2 * standard_error_percent);
}

TEST(DirectScatter, IsWhatTheStandardErrorsSayAtEveryLevel) {
  const char* given = std::getenv("TODBENCH_STUDY_RUNS");
  const int runs = given != nullptr ? std::atoi(given) : 200;
  struct Level {
    std::string name;
    Accuracy accuracy;
    int runs = 0;
  };
  const Level levels[] = {{"draft", Accuracy::draft(), runs}, {"normal", Accuracy::normal(), runs},
                          {"2.5 % asked", asked(2.5), runs},  {"1 % asked", asked(1), runs},
                          {"0.5 % asked", asked(0.5), runs},  {"reference", Accuracy::reference(), runs / 4}};
  std::printf("| level | contrast | runs | draws | scatter | stated | ratio | s |\n");
  for (const Level& level : levels) {
    double seconds = 0;
    for (const DirectScatter& s :
         direct_scatter(test::sc2000(), {16.9, 1.93, 0.23}, level.accuracy, level.runs, 1, &seconds)) {
      std::printf("| %s | %g K | %d | %d to %d | %.3f %% | %.3f %% | %.3f | %.3f |\n", level.name.c_str(), s.delta_t_k,
                  level.runs, s.fewest_draws, s.most_draws, s.scatter_percent, s.stated_percent, s.ratio(), seconds);
      std::fflush(stdout);
      EXPECT_NEAR(s.ratio(), 1, 3 / std::sqrt(2.0 * level.runs)) << level.name << " " << s.delta_t_k;
    }
  }
}

}  // namespace
}  // namespace todbench::testing
