// SPDX-License-Identifier: GPL-3.0-or-later
// Every extreme value that a plan may have, through measure, simulate and plan. TODBENCH_STUDY_RUNS: how many (all
// without it).
#include <cstdlib>

#include "tests/system/extreme_values.h"

namespace todbench::testing {
namespace {

int most_runs() {
  const char* asked = std::getenv("TODBENCH_STUDY_RUNS");
  return asked == nullptr ? 1000000 : std::atoi(asked);
}

TEST(ExtremeValuesStudy, GiveFiniteNumbers) {
  const TemporaryFolder folder;
  int runs = 0;
  for (const ExtremePlan& extreme : extreme_plans(plan_of_every_section())) {
    if (!parse_plan({"plan.toml", extreme.toml}, ".")) continue;
    if (++runs > most_runs()) break;
    const std::string about = path_of(*extreme.at.section, *extreme.at.key) + " = " + extreme.value;
    folder.write("plan.toml", extreme.toml);
    const auto run = [&](const std::vector<std::string>& arguments) {
      expect_refused_or_finite(todbench(arguments, {.folder = folder.path()}), arguments.front() + " " + about);
    };
    run({"measure", "./plan.toml", "--out", "m" + std::to_string(runs), "--json"});
    run({"simulate", "./plan.toml", "--out", "s" + std::to_string(runs), "--json"});
    run({"plan", "./plan.toml", "--json"});
  }
}

}  // namespace
}  // namespace todbench::testing
