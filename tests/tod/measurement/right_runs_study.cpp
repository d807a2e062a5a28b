// SPDX-License-Identifier: GPL-3.0-or-later
// False alarms of the checks of place and constancy over whole runs. TODBENCH_STUDY_RUNS: how many of each camera, 25
// for each of its fixed patterns (500 without it: three minutes). TODBENCH_STUDY_DESIGN: this camera alone.
// TODBENCH_STUDY_SHARE: "1/2", every second fixed pattern, for two processes at once.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "tests/tod/measurement/right_runs.h"

namespace todbench::test {
namespace {

TEST(RightRunsStudy, HaveAFalseAlarmInOnePerCentAtMost) {
  constexpr int runs_of_a_pattern = 25;
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  const int patterns = ((asked != nullptr ? std::atoi(asked) : 500) + runs_of_a_pattern - 1) / runs_of_a_pattern;
  int first = 1, step = 1;
  char slash = 0;
  if (const char* share = std::getenv("TODBENCH_STUDY_SHARE")) std::istringstream(share) >> first >> slash >> step;
  std::printf(
      "| camera | runs | place | followed | transfer | presented | noise | correlation | residue | largest of "
      "presented |\n");
  std::array<int, 7> sum{};
  int runs = 0;
  const char* only = std::getenv("TODBENCH_STUDY_DESIGN");
  for (const RightCamera& camera : right_cameras()) {
    if (only != nullptr && camera.name != only) continue;
    std::array<int, 7> alarms{};
    int of_camera = 0;
    double largest = 0;
    for (int seed = first; seed <= patterns; seed += step) {
      const FalseAlarms found = right_runs(camera, static_cast<std::uint64_t>(seed), runs_of_a_pattern);
      of_camera += found.runs;
      largest = std::max(largest, found.largest_presented);
      std::ranges::transform(alarms, found.all(), alarms.begin(), std::plus<>());
    }
    std::printf("| %s | %d", camera.name.c_str(), of_camera);
    for (const int count : alarms) std::printf(" | %d", count);
    std::printf(" | %.2f |\n", largest);
    std::fflush(stdout);
    runs += of_camera;
    std::ranges::transform(sum, alarms, sum.begin(), std::plus<>());
  }
  for (const int count : sum) EXPECT_LE(count, runs / 100);
}

}  // namespace
}  // namespace todbench::test
