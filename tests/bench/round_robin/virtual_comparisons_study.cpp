// SPDX-License-Identifier: GPL-3.0-or-later
// 300 virtual comparisons of eight laboratories for each of TODBENCH_STUDY_RUNS seeds (5). Prints the table of
// docs/validation/coverage.md.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "tests/bench/round_robin/virtual_comparisons.h"

namespace todbench::testing {
namespace {

struct StudiedDesign {
  const char* name;
  VirtualDesign design;
};

TEST(VirtualComparisons, HoldTheTruthFindABiasAndRaiseFewAlarms) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const std::uint64_t seeds = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 5;
  std::printf("| design | seed | truth held | bias found | false alarms | E_n above 1 | procedure A |\n");
  for (const StudiedDesign& studied :
       {StudiedDesign{"3 items, no bias", {}}, StudiedDesign{"3 items, bias of 3 u", {.bias_u = 3}},
        StudiedDesign{"2 items, bias of 3 u", {.items = 2, .bias_u = 3}},
        StudiedDesign{"1 item, no bias", {.items = 1}}, StudiedDesign{"1 item, bias of 3 u", {.items = 1, .bias_u = 3}},
        StudiedDesign{"1 item, bias of 5 u", {.items = 1, .bias_u = 5}},
        StudiedDesign{"3 items, scatter of 2 u", {.scatter_u = 2}}}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      VirtualDesign design = studied.design;
      design.seed = seed;
      const VirtualSummary s = summary_of(design);
      std::printf("| %s | %d | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.1f %% |\n", studied.name,
                  static_cast<int>(seed), 100 * s.held, 100 * s.found, 100 * s.false_alarm, 100 * s.e_n_above,
                  100 * s.procedure_a);
      std::fflush(stdout);
      if (design.items < 3 || design.scatter_u > 0) continue;
      EXPECT_GE(s.held, 0.93) << studied.name << " " << seed;
      EXPECT_LE(s.held, 0.97) << studied.name << " " << seed;
      EXPECT_LE(s.false_alarm, 0.05) << studied.name << " " << seed;
      if (design.bias_u > 0) {
        EXPECT_GE(s.found, 0.9) << seed;
      }
    }
  }
}

}  // namespace
}  // namespace todbench::testing
