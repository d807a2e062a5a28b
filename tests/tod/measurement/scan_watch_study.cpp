// SPDX-License-Identifier: GPL-3.0-or-later
// How often a right scan is refused, and a wrong one is not. TODBENCH_STUDY_RUNS: how many wrong ones of each row (100
// without it); of right ones ten times as many, so that no refusal proves less than 0.15 % in both rows together.
#include <cstdio>
#include <cstdlib>

#include "tests/tod/measurement/scans.h"

namespace todbench::test {
namespace {

TEST(ScanWatchStudy, RefusesTheWrongScansAlone) {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const int runs = asked != nullptr ? std::atoi(asked) : 100;
  ScanPictures pictures;
  std::printf("| contrast | scan moves | runs | refused |\n");
  for (const double contrast_k : {16.9, 0.5}) {
    for (const double moves : {1.0, 0.0, 0.5}) {
      const Scan scan{.moves = moves, .contrast_k = contrast_k};
      const int of_row = moves == 1 ? 10 * runs : runs;
      int refused = 0;
      for (int seed = 1; seed <= of_row; ++seed)
        refused += refusal_of(scan, static_cast<std::uint64_t>(seed), pictures).empty() ? 0 : 1;
      std::printf("| %g K | %g of the step | %d | %d |\n", contrast_k, moves, of_row, refused);
      std::fflush(stdout);
      if (moves == 1)
        EXPECT_EQ(refused, 0);
      else
        EXPECT_GE(refused, runs * 99 / 100);
    }
  }
}

}  // namespace
}  // namespace todbench::test
