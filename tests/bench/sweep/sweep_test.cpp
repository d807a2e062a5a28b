// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps: what tasks there are, what files are refused, what schedulers are told.
#include "bench/sweep/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "bench/sweep/schedulers.h"
#include "bench/sweep/task_plan.h"
#include "bench/text/files.h"
#include "tests/bench/sweep/sweep_support.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using namespace testing_support;
using ::testing::HasSubstr;
using testing::TemporaryFolder;

TEST(SweepGrid, IsAFullFactorialInTheOrderOfTheFileWithTheLastKeyFastest) {
  const Sweep sweep =
      expanded("[grid]\nz = [1, 2]\na = { from = 0, to = 1, steps = 3 }\nword = [\"x\", \"y\"]\n[repeat]\nseeds = 2\n");

  ASSERT_EQ(sweep.count(), 24u);
  EXPECT_EQ(values_of(sweep, 0), (std::vector<std::string>{"1", "0", "x"}));
  EXPECT_EQ(values_of(sweep, 1), values_of(sweep, 0)) << "repeats are fastest";
  EXPECT_EQ(values_of(sweep, 2), (std::vector<std::string>{"1", "0", "y"}));
  EXPECT_EQ(values_of(sweep, 4), (std::vector<std::string>{"1", "0.5", "x"}));
  EXPECT_EQ(values_of(sweep, 23), (std::vector<std::string>{"2", "1", "y"}));
}

TEST(SweepSeeds, DependOnContentAndNotOnTheIndex) {
  const Sweep before = expanded("[grid]\na = [1, 2]\nb = [5]\n[repeat]\nseeds = 2\n");
  const Sweep after = expanded("[grid]\nb = [4, 5]\na = [3, 1, 2]\n[repeat]\nseeds = 2\n");
  const auto seeds_of = [](const Sweep& sweep) {
    std::map<std::string, std::uint64_t> seeds;
    for (std::size_t i = 0; i < sweep.count(); ++i) {
      std::map<std::string, std::string> values;
      for (const auto& [key, value] : sweep.task(i).parameters) values[key] = value;
      seeds[values["a"] + "," + values["b"] + "," + std::to_string(sweep.task(i).repeat)] = sweep.task(i).seed;
    }
    return seeds;
  };

  const auto old_seeds = seeds_of(before), new_seeds = seeds_of(after);

  for (const auto& [key, seed] : old_seeds) EXPECT_EQ(new_seeds.at(key), seed) << key;
  std::set<std::uint64_t> different;
  for (const auto& [key, seed] : new_seeds) different.insert(seed);
  EXPECT_EQ(different.size(), new_seeds.size());
}

TEST(SweepSeeds, OfAPairedSweepDependOnTheRepeatAlone) {
  const Sweep sweep = expanded("paired = true\n[grid]\na = [1, 2]\n[repeat]\nseeds = 2\n");

  EXPECT_EQ(sweep.task(0).seed, sweep.task(2).seed);
  EXPECT_NE(sweep.task(0).seed, sweep.task(1).seed);
  EXPECT_NE(sweep.task(0).name.substr(8), sweep.task(2).name.substr(8));
}

TEST(SweepZip, TakesItsListsTogether) {
  const Sweep sweep = expanded("[zip]\na = [1, 2]\nb = [10, 20]\n[grid]\nc = [0, 1]\n");

  ASSERT_EQ(sweep.count(), 4u);
  EXPECT_EQ(values_of(sweep, 1), (std::vector<std::string>{"0", "2", "20"}));
}

TEST(SweepSample, OfALatinHypercubeHasOneDrawInEveryRowAndColumn) {
  for (const std::size_t n : {1u, 7u, 64u}) {
    const auto rows = unit_sample(SampleKind::latin_hypercube, n, 3, 5);
    for (std::size_t d = 0; d < 3; ++d) {
      std::set<std::size_t> cells;
      for (const auto& row : rows) cells.insert(static_cast<std::size_t>(row[d] * static_cast<double>(n)));
      EXPECT_EQ(cells.size(), n);
    }
  }
}

TEST(SweepSample, OfSobolFillsTheCubeMoreEvenlyThanChance) {
  const std::size_t n = 1024;
  const auto rows = unit_sample(SampleKind::sobol, n, 4, 9);

  // The mean of x y over the square is 1/4; of so many independent draws its standard error is sqrt(7/144 / n) =
  // 0.0069.
  double sum = 0;
  for (const auto& row : rows) sum += row[1] * row[3] / static_cast<double>(n);
  EXPECT_NEAR(sum, 0.25, 0.0069 / 5);
}

// A (0, m, 2)-net for the first two axes (Sobol 1967), a (0, m, 1)-net for each; the shift keeps both.
TEST(SweepSample, OfSobolHasOneDrawInEveryElementaryPart) {
  for (const std::uint64_t seed : {1u, 7u}) {
    for (const int m : {3, 6}) {
      const auto rows = unit_sample(SampleKind::sobol, std::size_t{1} << m, 3, seed);
      for (int i = 0; i <= m; ++i) {
        std::set<std::pair<int, int>> parts;
        for (const auto& row : rows)
          parts.insert({static_cast<int>(std::ldexp(row[0], i)), static_cast<int>(std::ldexp(row[1], m - i))});
        EXPECT_EQ(parts.size(), rows.size()) << seed << " " << m << " " << i;
      }
      std::set<int> third;
      for (const auto& row : rows) third.insert(static_cast<int>(std::ldexp(row[2], m)));
      EXPECT_EQ(third.size(), rows.size()) << seed << " " << m;
    }
  }
}

TEST(SweepConstraint, DecidesWhichCombinationsThereAre) {
  const Sweep sweep =
      expanded("where = \"a <= b and (a + 1) * 2 != 4 or a == 9\"\n[grid]\na = [1, 2, 9]\nb = [2, 3]\n");

  EXPECT_EQ(sweep.count(), 4u);
  EXPECT_EQ(sweep.refused(), 2u);
  EXPECT_EQ(values_of(sweep, 0), (std::vector<std::string>{"2", "2"}));
}

TEST(SweepFile, IsRefusedInASentenceWithTheLine) {
  EXPECT_THAT(refusal("[grid]\na = 3\n"), HasSubstr("a.toml:2: expected a list of values"));
  EXPECT_THAT(refusal("[grid]\na = [1, 1.0]\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("[grid]\na = [1]\n[base]\na = 2\n"), HasSubstr("stated twice"));
  EXPECT_THAT(refusal("[zip]\na = [1, 2]\nb = [1]\n"), HasSubstr("the same length"));
  EXPECT_THAT(refusal("[gird]\na = [1]\n"), HasSubstr("did you mean 'grid'"));
  EXPECT_THAT(refusal("[repeat]\nseeds = 0\n"), HasSubstr("expected a whole number from 1"));
  EXPECT_THAT(refusal("[sample]\nn = 3\nranges = { a = [2, 1] }\n"), HasSubstr("low below high"));
  EXPECT_THAT(refusal("where = \"a <\"\n[grid]\na = [1]\n"), HasSubstr("expected a name or a number"));
  EXPECT_THAT(refusal("where = \"c < 1\"\n[grid]\na = [1]\n"), HasSubstr("'c' is not a known number"));
  EXPECT_THAT(refusal("where = \"a > 1\"\n[grid]\na = [1]\n"), HasSubstr("the conditions reject every combination"));
  EXPECT_THAT(refusal("[grid]\na = { from = 0, to = 1, steps = 1 }\n"), HasSubstr("steps"));
  EXPECT_THAT(refusal("[grid\n"), HasSubstr("a.toml:1"));
  std::string deep(10000, '(');
  EXPECT_THAT(refusal("where = \"" + deep + "\"\n[grid]\na = [1]\n"), HasSubstr("too many parentheses"));
  std::string wide = "[grid]\n";
  for (char c = 'a'; c < 'k'; ++c) wide += std::string(1, c) + " = { from = 0, to = 1, steps = 10 }\n";
  EXPECT_THAT(refusal(wide), HasSubstr("more than"));
}

TEST(Schedulers, CoverEveryTaskOnce) {
  const JobList jobs{.program = "todbench", .sweep_file = "my sweep.toml", .tasks = 7, .chunk = 3};

  EXPECT_EQ(job_text(Scheduler::parallel, jobs, {}),
            "todbench sweep run 'my sweep.toml' --quiet --range 0-2\n"
            "todbench sweep run 'my sweep.toml' --quiet --range 3-5\n"
            "todbench sweep run 'my sweep.toml' --quiet --range 6-6\n");
  EXPECT_THAT(job_text(Scheduler::slurm, jobs, {"--partition=short"}),
              ::testing::AllOf(HasSubstr("#SBATCH --array=0-2\n"), HasSubstr("#SBATCH --partition=short\n"),
                               HasSubstr("--chunk 3")));
  EXPECT_THAT(job_text(Scheduler::gridengine, jobs, {}), HasSubstr("#$ -t 1-3\n"));
  EXPECT_THAT(job_text(Scheduler::snakemake, jobs, {}), HasSubstr("range(3)"));
  EXPECT_THAT(job_text(Scheduler::make, jobs, {}), HasSubstr("seq 0 2"));
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_FALSE(site_options_from("rm -rf /\n", "site"));
  EXPECT_EQ(site_options_from("# of us\n\n --time=10 \n", "site").value(), std::vector<std::string>{"--time=10"});
}

TEST(LoadSweep, RefusesUnknownKeysAndValuesBeforeAnythingRuns) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& text) {
    folder.write("s.toml", text);
    const auto sweep = load_sweep(folder.path() / "s.toml");
    return sweep ? std::string("taken") : sweep.error().message;
  };

  EXPECT_THAT(refused("[grid]\nnetd = [0.05]\n"), HasSubstr("unknown parameter 'netd'"));
  EXPECT_THAT(refused("[grid]\nnetd_k = [0.05, -1]\n"), HasSubstr("netd_k"));
  EXPECT_THAT(refused("[base]\nobserver = \"nobody\"\n"), HasSubstr("unknown observer"));
  EXPECT_THAT(refused("[base]\naccuracy = \"best\"\n"), HasSubstr("accuracy"));
  EXPECT_EQ(refused("[base]\nsimulation.accuracy = \"draft\"\n[grid]\nsensor = [\"sc2000\"]\nnetd_k = [0.05]\n"),
            "taken");
}

}  // namespace
}  // namespace todbench
