// Sweeps: what tasks there are, where results go, what comes back.
#include "bench/sweep/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <stop_token>
#include <thread>

#include "acquisition/core/rng.h"
#include "bench/report/html.h"
#include "bench/sweep/processes.h"
#include "bench/sweep/result_store.h"
#include "bench/sweep/schedulers.h"
#include "bench/sweep/sweep_effects.h"
#include "bench/sweep/sweep_figures.h"
#include "bench/sweep/sweep_page.h"
#include "bench/sweep/sweep_table.h"
#include "bench/sweep/task_plan.h"
#include "bench/text/files.h"
#include "bench/text/text.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::TemporaryFolder;

std::optional<double> nobody(std::string_view) {
  return std::nullopt;
}

Sweep expanded(const std::string& text) {
  auto file = parse_sweep(text, "/tmp/a.toml");
  EXPECT_TRUE(file) << file.error().message;
  auto sweep = Sweep::expand(*file, "", nobody);
  EXPECT_TRUE(sweep) << sweep.error().message;
  return *sweep;
}

std::vector<std::string> values_of(const Sweep& sweep, std::size_t index) {
  std::vector<std::string> values;
  for (const auto& parameter : sweep.task(index).parameters) values.push_back(parameter.value);
  return values;
}

std::string refusal(const std::string& text) {
  const auto file = parse_sweep(text, "a.toml");
  if (!file) return file.error().message;
  const auto sweep = Sweep::expand(*file, "", nobody);
  return sweep ? "" : sweep.error().message;
}

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
  EXPECT_THAT(refusal("[zip]\na = [1, 2]\nb = [1]\n"), HasSubstr("one length"));
  EXPECT_THAT(refusal("[gird]\na = [1]\n"), HasSubstr("did you mean 'grid'"));
  EXPECT_THAT(refusal("[repeat]\nseeds = 0\n"), HasSubstr("expected a whole number from 1"));
  EXPECT_THAT(refusal("[sample]\nn = 3\nranges = { a = [2, 1] }\n"), HasSubstr("low below high"));
  EXPECT_THAT(refusal("where = \"a <\"\n[grid]\na = [1]\n"), HasSubstr("expected a name or a number"));
  EXPECT_THAT(refusal("where = \"c < 1\"\n[grid]\na = [1]\n"), HasSubstr("'c' is no number"));
  EXPECT_THAT(refusal("where = \"a > 1\"\n[grid]\na = [1]\n"), HasSubstr("every combination is refused"));
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

/// A sweep whose tasks take milliseconds: draft estimates of one contrast.
RunnableSweep quick_sweep(const TemporaryFolder& folder, const std::string& more = "") {
  folder.write("s.toml", "kind = \"estimate\"\nwhere = \"detector_um <= pitch_um\"\n" + more +
                             "[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n[grid]\nnetd_k = [0.07, 0.4]\n"
                             "detector_um = [30, 42.5]\n[repeat]\nseeds = 2\n");
  auto sweep = load_sweep(folder.path() / "s.toml");
  EXPECT_TRUE(sweep) << sweep.error().message;
  return *sweep;
}

TEST(SweepRun, IsIdempotentAndTheTableIsTheSameInAnyOrder) {
  const TemporaryFolder one, two;
  const RunnableSweep forwards = quick_sweep(one), backwards = quick_sweep(two);
  ASSERT_EQ(forwards.sweep.count(), 8u);

  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(run_and_store(forwards, i, {}).kind, TaskOutcome::Kind::done);
  for (std::size_t i = 8; i-- > 0;) EXPECT_EQ(run_and_store(backwards, i, {}).kind, TaskOutcome::Kind::done);

  EXPECT_EQ(run_and_store(forwards, 3, {}).kind, TaskOutcome::Kind::already_done);
  const auto a = collected(forwards.sweep, MissingTasks::refused),
             b = collected(backwards.sweep, MissingTasks::refused);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(to_csv(*a), to_csv(*b));
  EXPECT_EQ(a->rows.size(), 8u);
  ASSERT_TRUE(write_sqlite(*a, one.path() / "t.sqlite"));
  EXPECT_TRUE(std::filesystem::exists(one.path() / "t.sqlite"));
  const auto effects = sweep_effects(forwards.sweep, *a, "acuity_per_mrad");
  ASSERT_EQ(effects.size(), 1u);
  // More noise costs acuity.
  const auto& netd = effects[0].parameters[0];
  EXPECT_GT(netd.levels[0].mean, netd.levels[1].mean);
  EXPECT_TRUE(netd.first_order && netd.total && netd.first_order_ci95.low);
}

TEST(SweepStatus, TellsWhatIsDoneMissingStaleAndForeign) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  ASSERT_EQ(run_and_store(runnable, 2, {}).kind, TaskOutcome::Kind::done);
  const auto place = [&](std::size_t i, const char* ending) {
    return result_file(runnable.sweep, runnable.sweep.task(i)).replace_extension(ending);
  };
  std::ofstream(place(4, ".lock")) << "a-host-that-is-not-this-one\n1\n";
  std::ofstream(place(5, ".failed")) << "no such sensor\n";
  // No process has this number: it is above the largest that the kernel gives.
  std::array<char, 256> host{};
  ASSERT_EQ(::gethostname(host.data(), host.size() - 1), 0);
  std::ofstream(place(6, ".lock")) << host.data() << "\n99999999\n";

  const SweepStatus status = sweep_status(runnable.sweep);

  EXPECT_EQ(status.count(TaskState::done), 1u);
  EXPECT_EQ(status.states[4], TaskState::running);
  EXPECT_EQ(status.states[5], TaskState::failed);
  EXPECT_EQ(status.states[6], TaskState::stale);
  EXPECT_EQ(status.open_list(), "0-1,3-7");
  EXPECT_EQ(failure_of(runnable.sweep, 5), "no such sensor");
  EXPECT_EQ(run_and_store(runnable, 4, {}).kind, TaskOutcome::Kind::locked);
  EXPECT_EQ(run_and_store(runnable, 6, {}).kind, TaskOutcome::Kind::done) << "a stale lock is no lock";
  const auto refused = collected(runnable.sweep, MissingTasks::refused);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::not_identifiable);
  EXPECT_EQ(collected(runnable.sweep, MissingTasks::left_out)->rows.size(), 2u);

  const RunnableSweep other = quick_sweep(folder, "seed = 7\n");
  EXPECT_EQ(sweep_status(other.sweep).states[2], TaskState::foreign);
  EXPECT_EQ(run_and_store(other, 2, {}).kind, TaskOutcome::Kind::failed);
  EXPECT_FALSE(collected(other.sweep, MissingTasks::left_out));
}

TEST(SweepRun, OfAnElementThatSlurmStartedAgainTakesOverTheLockOfItsLostNode) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  ASSERT_EQ(run_and_store(runnable, 0, {}).kind, TaskOutcome::Kind::done);
  const auto leave_lock = [&](std::size_t i) {
    std::ofstream(result_file(runnable.sweep, runnable.sweep.task(i)).replace_extension(".lock"))
        << "a-node-that-was-lost\n1\n12_3\n1\n";
  };
  leave_lock(1);
  leave_lock(2);
  ::setenv("SLURM_ARRAY_JOB_ID", "12", 1);
  ::setenv("SLURM_ARRAY_TASK_ID", "3", 1);
  ::setenv("SLURM_RESTART_COUNT", "1", 1);

  const auto same_start = run_and_store(runnable, 1, {}).kind;
  ::setenv("SLURM_RESTART_COUNT", "2", 1);
  const auto later_start = run_and_store(runnable, 1, {}).kind;
  ::setenv("SLURM_ARRAY_TASK_ID", "4", 1);
  const auto another_element = run_and_store(runnable, 2, {}).kind;
  for (const char* name : {"SLURM_ARRAY_JOB_ID", "SLURM_ARRAY_TASK_ID", "SLURM_RESTART_COUNT"}) ::unsetenv(name);

  EXPECT_EQ(same_start, TaskOutcome::Kind::locked);
  EXPECT_EQ(later_start, TaskOutcome::Kind::done);
  EXPECT_EQ(another_element, TaskOutcome::Kind::locked);
}

TEST(SweepCollect, RefusesResultsOfSeveralVersions) {
  const TemporaryFolder folder;
  const RunnableSweep runnable = quick_sweep(folder);
  for (std::size_t i = 0; i < 2; ++i) ASSERT_EQ(run_and_store(runnable, i, {}).kind, TaskOutcome::Kind::done);
  const auto file = result_file(runnable.sweep, runnable.sweep.task(1));
  std::string text = *read_text_file(file);
  const auto place = text.find("\"version\": \"");
  ASSERT_NE(place, std::string::npos);
  text.insert(place + 12, "9");
  ASSERT_TRUE(write_file_atomically(file, text));

  const auto table = collected(runnable.sweep, MissingTasks::left_out);

  ASSERT_FALSE(table);
  EXPECT_THAT(table.error().message, HasSubstr("several versions"));
}

TEST(SweepEffects, OfAnAdditiveResponseAreItsSharesOfVariance) {
  const Sweep sweep = expanded("[grid]\na = [0, 1]\nb = [0, 1]\n[repeat]\nseeds = 3\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  for (int repeat = 0; repeat < 3; ++repeat) {
    for (const int a : {0, 1}) {
      for (const int b : {0, 1}) table.rows.push_back({a, b, repeat, 3.0 * a + 1.0 * b});
    }
  }

  const auto effects = sweep_effects(sweep, table, "y");

  ASSERT_EQ(effects.size(), 1u);
  // Variances 9/4 and 1/4 of 10/4; without interactions the total is the first order.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.9, 1e-12);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0.1, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].total.value(), 0.9, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].levels[1].mean, 3.5, 1e-12);
  EXPECT_NEAR(effects[0].parameters[0].levels[1].ci95.low.value(), 3.5, 1e-12);
}

TEST(SweepEffects, OfADrawnSampleComeFromClasses) {
  const Sweep sweep = expanded("[sample]\nkind = \"sobol\"\nn = 512\nranges = { a = [0, 1], b = [0, 1] }\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    const double a = *parse_number(values[0]), b = *parse_number(values[1]);
    table.rows.push_back({a, b, 0, 2 * a + b});
  }

  const auto effects = sweep_effects(sweep, table, "y");

  // Shares 4/5 and 1/5; sixteen classes leave 1/256 of a parameter's own variance within them. In a net the other
  // parameter is alike in all classes: nothing is taken off for chance.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.8 * 255 / 256, 1e-4);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0.2 * 255 / 256, 1e-4);
  // The response is a plane: its ends are exact, b at its middle.
  ASSERT_EQ(effects[0].parameters[0].ends.size(), 2u);
  EXPECT_NEAR(effects[0].parameters[0].ends[0].mean, 0.5, 1e-9);
  EXPECT_NEAR(effects[0].parameters[0].ends[1].mean, 2.5, 1e-9);
  EXPECT_GT(effects[0].parameters[0].levels.size(), 2u);
}

// Scatter of repeats alone: sixteen classes of 512 draws would explain 3 % of it by chance.
TEST(SweepEffects, OfNothingAreNothing) {
  const Sweep sweep =
      expanded("[sample]\nkind = \"sobol\"\nn = 512\nranges = { a = [0, 1], b = [0, 1] }\n[repeat]\nseeds = 4\n");
  SweepTable table;
  table.columns = {"a", "b", "repeat", "y"};
  const RandomStream noise(5, "sweep_test.noise");
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    table.rows.push_back({*parse_number(values[0]), *parse_number(values[1]), sweep.task(i).repeat, noise.normal(i)});
  }

  const auto effects = sweep_effects(sweep, table, "y");

  // eta^2 (n - 1) is chi-squared with 15 degrees of freedom: standard deviation sqrt(30) / 511 of one repeat.
  for (const auto& parameter : effects[0].parameters)
    EXPECT_NEAR(parameter.first_order.value(), 0, 3 * std::sqrt(30.0) / 511 / 2);
}

using Response = std::function<double(const std::vector<double>& x, std::size_t index)>;

/// What `collect` makes of results that are this function.
SweepTable table_of(const Sweep& sweep, const Response& response) {
  SweepTable table;
  table.columns = sweep.keys();
  table.columns.insert(table.columns.begin(), "index");
  table.columns.insert(table.columns.end(), {"repeat", "y"});
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    Json row = {i};
    std::vector<double> x;
    for (const auto& value : values_of(sweep, i)) x.push_back(*parse_number(value));
    for (const double value : x) row.push_back(value);
    row.push_back(sweep.task(i).repeat);
    row.push_back(response(x, i));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string total_sample(std::size_t n, int seed, const std::string& ranges) {
  return "[sample]\nkind = \"sobol\"\ntotal = true\nn = " + std::to_string(n) + "\nseed = " + std::to_string(seed) +
         "\nranges = { " + ranges + " }\n";
}

struct KnownIndices {
  std::string ranges;
  Response response;
  std::vector<double> first, total;
};

/// Ishigami and Homma 1990 with a = 7, b = 0.1.
KnownIndices ishigami() {
  constexpr double pi = 3.14159265358979323846, a = 7, b = 0.1;
  const double v1 = std::pow(1 + b * std::pow(pi, 4) / 5, 2) / 2, v2 = a * a / 8,
               v13 = 8 * b * b * std::pow(pi, 8) / 225, v = v1 + v2 + v13;
  const std::string range = " = [-3.141592653589793, 3.141592653589793]";
  return {"a" + range + ", b" + range + ", c" + range,
          [](const std::vector<double>& x, std::size_t) {
            return std::sin(x[0]) + a * std::pow(std::sin(x[1]), 2) + b * std::pow(x[2], 4) * std::sin(x[0]);
          },
          {v1 / v, v2 / v, 0},
          {(v1 + v13) / v, v2 / v, v13 / v}};
}

/// The g-function of Sobol 1993 with a = 0, 1, 4.5, 9, 99.
KnownIndices sobol_g() {
  const std::vector<double> a{0, 1, 4.5, 9, 99};
  KnownIndices known{"a = [0, 1], b = [0, 1], c = [0, 1], d = [0, 1], e = [0, 1]",
                     [a](const std::vector<double>& x, std::size_t) {
                       double product = 1;
                       for (std::size_t i = 0; i < a.size(); ++i)
                         product *= (std::abs(4 * x[i] - 2) + a[i]) / (1 + a[i]);
                       return product;
                     },
                     {},
                     {}};
  double all = 1;
  for (const double one : a) all *= 1 + 1 / (3 * (1 + one) * (1 + one));
  for (const double one : a) {
    const double v = 1 / (3 * (1 + one) * (1 + one));
    known.first.push_back(v / (all - 1));
    known.total.push_back(v * all / (1 + v) / (all - 1));
  }
  return known;
}

TEST(SweepTotalIndices, AreThoseOfFunctionsWhoseIndicesAreKnown) {
  for (const KnownIndices& known : {ishigami(), sobol_g()}) {
    const Sweep sweep = expanded(total_sample(2048, 1, known.ranges));
    EXPECT_EQ(sweep.count(), 2048 * (known.first.size() + 2));

    const auto effects = sweep_effects(sweep, table_of(sweep, known.response), "y");

    ASSERT_EQ(effects.size(), 1u);
    EXPECT_EQ(effects[0].draws, 2048u);
    for (std::size_t k = 0; k < known.first.size(); ++k) {
      const ParameterEffect& found = effects[0].parameters[k];
      EXPECT_NEAR(found.first_order.value(), known.first[k], 0.02) << k;
      EXPECT_NEAR(found.total.value(), known.total[k], 0.02) << k;
    }
  }
}

// Forty seeds, sixteen indices each: of intervals that held in 95 % of independent ones 608 would, with a standard
// deviation below 10 were they independent; those of a net are rather too wide.
TEST(SweepTotalIndices, LieWithinTheirIntervals) {
  int held = 0, all = 0;
  for (const KnownIndices& known : {ishigami(), sobol_g()}) {
    for (int seed = 1; seed <= 40; ++seed) {
      const Sweep sweep = expanded(total_sample(128, seed, known.ranges));
      const auto effects = sweep_effects(sweep, table_of(sweep, known.response), "y");
      for (std::size_t k = 0; k < known.first.size(); ++k) {
        const ParameterEffect& found = effects[0].parameters[k];
        for (const auto& [interval, truth] :
             {std::pair(found.first_order_ci95, known.first[k]), std::pair(found.total_ci95, known.total[k])}) {
          ++all;
          held += *interval.low <= truth && truth <= *interval.high ? 1 : 0;
        }
      }
    }
  }
  RecordProperty("intervals_that_held", held);
  EXPECT_EQ(all, 640);
  EXPECT_GE(held, 588);
}

TEST(SweepTotalIndices, OfNoiseOfTasksAreNobodysShare) {
  const RandomStream noise(7, "sweep_test.total");
  const Sweep sweep = expanded(total_sample(512, 1, "a = [0, 1], b = [0, 1]") + "[repeat]\nseeds = 2\n");

  const auto effects = sweep_effects(
      sweep,
      table_of(sweep, [&](const auto& x, std::size_t i) { return x[0] + noise.normal(i) * std::sqrt(1.0 / 12); }), "y");

  // Half of the variance is that of a, half nobody's; 0.05 is three standard errors of 512 draws in two repeats.
  EXPECT_NEAR(effects[0].parameters[0].first_order.value(), 0.5, 0.06);
  EXPECT_NEAR(effects[0].parameters[0].total.value(), 0.5, 0.06);
  EXPECT_NEAR(effects[0].parameters[1].first_order.value(), 0, 0.06);
  EXPECT_NEAR(effects[0].parameters[1].total.value(), 0, 0.06);
}

TEST(SweepTotalIndices, AreOfWholeDrawsAndAskForThem) {
  const Sweep sweep = expanded(total_sample(64, 1, "a = [0, 1], b = [0, 1]"));
  SweepTable table = table_of(sweep, [](const auto& x, std::size_t) { return x[0]; });
  table.rows.erase(table.rows.begin() + 5);

  EXPECT_EQ(sweep_effects(sweep, table, "y")[0].draws, 63u);
  const Sweep more = expanded(total_sample(65, 1, "a = [0, 1], b = [0, 1]"));
  for (std::size_t i = 0; i < sweep.count(); ++i) EXPECT_EQ(sweep.task(i).name, more.task(i).name) << "draws are added";
  EXPECT_EQ(values_of(sweep, 2)[0], values_of(sweep, 1)[0]) << "A with the first parameter of B";
  EXPECT_EQ(values_of(sweep, 2)[1], values_of(sweep, 0)[1]);
  EXPECT_NE(refusal("[sample]\nn = 4\ntotal = true\nranges = { a = [0, 1] }\n"), "");
  EXPECT_NE(refusal("[sample]\nkind = \"sobol\"\nn = 4\ntotal = 1\nranges = { a = [0, 1] }\n"), "");
  EXPECT_NE(refusal("where = \"a < 1\"\n" + total_sample(4, 1, "a = [0, 1]")), "");
  EXPECT_NE(refusal("[grid]\nb = [1]\n" + total_sample(4, 1, "a = [0, 1]")), "");
  EXPECT_NE(refusal(total_sample(4'000'000, 1, "a = [0, 1]")), "") << "more than ten million tasks";
}

TEST(SweepContours, OfDrawnParametersAreMeansOfSquaresWithTheNumberOfDraws) {
  const RandomStream noise(3, "sweep_test.contours");
  const auto plane = [](const auto& x, std::size_t) { return x[1] + 2 * x[2]; };
  const std::string ranges = "ranges = { other = [0, 1], a = [0, 1], b = [10, 12] }\n";
  for (const std::string& text : {"[sample]\nkind = \"sobol\"\nn = 1024\n" + ranges, "[sample]\nn = 1024\n" + ranges,
                                  total_sample(512, 1, "other = [0, 1], a = [0, 1], b = [10, 12]")}) {
    const Sweep sweep = expanded(text + "[repeat]\nseeds = 2\n");
    const SweepTable table = table_of(sweep, plane);
    const auto effects = sweep_effects(sweep, table, "y");

    const auto grid = response_grid(sweep, table, effects[0]);

    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_EQ(grid->x_key, "b");
    EXPECT_EQ(grid->y_key, "a");
    EXPECT_EQ(grid->points, 1024u) << "repeats are no draws, mixtures of A and B neither";
    EXPECT_GE(grid->least, 8u);
    ASSERT_GE(grid->x.size(), 5u);
    // A draw lies within half a square of the middle: the mean of eight or more is off by at most so much.
    const double half = 0.5 / static_cast<double>(grid->x.size());
    for (std::size_t i = 0; i < grid->x.size(); ++i) {
      for (std::size_t j = 0; j < grid->y.size(); ++j)
        EXPECT_NEAR(grid->mean[i][j], grid->y[j] + 2 * grid->x[i], half * (1 + 4));
    }
    EXPECT_TRUE(contour_plot(*grid, effects[0], "c"));

    const SweepTable chance = table_of(sweep, [&](const auto&, std::size_t i) { return noise.normal(i); });
    EXPECT_EQ(response_grid(sweep, chance, sweep_effects(sweep, chance, "y")[0]).error().code,
              ErrorCode::not_identifiable);
  }
  const Sweep few = expanded("[sample]\nn = 40\n" + ranges);
  const SweepTable table = table_of(few, plane);
  EXPECT_EQ(response_grid(few, table, sweep_effects(few, table, "y")[0]).error().code, ErrorCode::not_identifiable);
}

/// A grid whose response is a function of its two parameters.
ResponseGrid grid_of(const std::function<double(double, double)>& response) {
  ResponseGrid grid{.x_key = "a", .y_key = "b", .x = {0, 1, 3}, .y = {-1, 2}, .mean = {}};
  for (const double x : grid.x) {
    grid.mean.emplace_back();
    for (const double y : grid.y) grid.mean.back().push_back(response(x, y));
  }
  return grid;
}

TEST(SweepContours, OfAPlaneAreStraightLinesThroughEveryCell) {
  const auto grid = grid_of([](double x, double y) { return x + 2 * y; });

  const auto stretches = contour(grid, 1.5);

  ASSERT_EQ(stretches.size(), 2u);
  double length = 0;
  for (const auto& [from, to] : stretches) {
    EXPECT_NEAR(from.x + 2 * from.y, 1.5, 1e-12);
    EXPECT_NEAR(to.x + 2 * to.y, 1.5, 1e-12);
    length += std::hypot(to.x - from.x, to.y - from.y);
  }
  // From x = 0 (y = 0.75) to x = 3 (y = -0.75).
  EXPECT_NEAR(length, std::hypot(3, 1.5), 1e-12);
  EXPECT_TRUE(contour(grid, 100).empty());
}

TEST(SweepContours, OfASaddleCutOffTheCornersThatTheMiddleDoesNotBelongTo) {
  ResponseGrid grid{.x_key = "a", .y_key = "b", .x = {0, 1}, .y = {0, 1}, .mean = {{1, 0}, {0, 1}}};

  const auto low = contour(grid, 0.25), high = contour(grid, 0.75);

  // The middle is 0.5: above 0.25 it belongs to (0, 0) and (1, 1), so the lines cut off (1, 0) and (0, 1).
  ASSERT_EQ(low.size(), 2u);
  for (const auto& [from, to] : low) EXPECT_GT(std::abs((from.x + to.x) / 2 - (from.y + to.y) / 2), 0.5);
  ASSERT_EQ(high.size(), 2u);
  for (const auto& [from, to] : high) EXPECT_GT(std::abs((from.x + to.x) / 2 + (from.y + to.y) / 2 - 1), 0.5);
}

TEST(SweepPage, HasAFigureForEveryQuestionOrSaysWhyThereIsNone) {
  SweepTable table;
  table.columns = {"a", "b", "word", "repeat", "delta_t_k", "y"};
  const Sweep sweep = expanded("[grid]\na = [0, 1, 2]\nb = [0, 1]\nword = [\"x\", \"<y>\"]\n[repeat]\nseeds = 2\n");
  for (std::size_t i = 0; i < sweep.count(); ++i) {
    const auto values = values_of(sweep, i);
    const double a = *parse_number(values[0]), b = *parse_number(values[1]);
    table.rows.push_back({a, b, values[2], sweep.task(i).repeat, 2.0, 3 * a + b + 0.01 * static_cast<double>(i % 2)});
  }
  table.tasks = sweep.count();
  const auto effects = sweep_effects(sweep, table, "y");
  ASSERT_EQ(effects.size(), 1u);

  const auto tornado_drawing = tornado(effects[0], "t");
  const auto grid = response_grid(sweep, table, effects[0]);
  const std::string page = render_html(sweep_page(sweep, table, effects));

  ASSERT_TRUE(tornado_drawing && grid);
  EXPECT_EQ(tornado_drawing->labels.size() > 6, true);
  EXPECT_EQ(grid->x_key, "a");
  EXPECT_NEAR(grid->mean[2][1], 7.005, 1e-12);
  EXPECT_THAT(page, HasSubstr("&lt;y&gt;"));
  EXPECT_FALSE(response_curve(effects[0], effects[0].parameters[2], "c"));
  EXPECT_TRUE(render_html(sweep_page(sweep, table, {})).size() > 100);
  ResponseEffects one{"y", 1, {{.key = "a", .levels = {{"1", 2, {}, 1}}}}};
  EXPECT_EQ(tornado(one, "t").error().code, ErrorCode::not_identifiable);
  EXPECT_EQ(response_grid(sweep, SweepTable{}, effects[0]).error().code, ErrorCode::not_identifiable);
}

TEST(ShippedSweeps, GiveATableInTheirShortForm) {
  const TemporaryFolder folder;
  for (const char* name : {"sc2000-sensitivity", "observer-and-sensor", "budget-tolerance"}) {
    const std::string text = *read_text_file(source_file(std::string("bench/sweeps/") + name + ".toml"));
    folder.write(std::string(name) + ".toml", text);
    const auto runnable = load_sweep(folder.path() / (std::string(name) + ".toml"));
    ASSERT_TRUE(runnable) << runnable.error().message;
    EXPECT_EQ(runnable->sweep.refused(), 0u) << name;
    // The first task and the last stand for the others.
    for (const std::size_t i : {std::size_t{0}, runnable->sweep.count() - 1})
      EXPECT_EQ(run_and_store(*runnable, i, {}).kind, TaskOutcome::Kind::done) << name;
    EXPECT_EQ(collected(runnable->sweep, MissingTasks::left_out)->rows.size(), 4u) << name;
  }
}

/// Chunks of two tasks of five, each a shell that says how it ended.
ProcessPool pool_of(const std::string& script, std::size_t jobs) {
  return {.tasks = 5, .jobs = jobs, .chunk = 2, .command = [script](std::size_t first, std::size_t last) {
            return std::vector<std::string>{"/bin/sh", "-c", script, "sh", std::to_string(first), std::to_string(last)};
          }};
}

TEST(ProcessPool, RunsEveryChunkAndSaysTheWorstExitCode) {
  const TemporaryFolder folder;
  for (const std::size_t jobs : {1u, 2u, 9u}) {
    const auto name = folder.path() / std::to_string(jobs);
    ProcessPool pool = pool_of("echo $1-$2 >> " + name.string() + "; exit $1", jobs);
    std::vector<std::size_t> progress;
    pool.on_progress = [&](std::size_t done) { progress.push_back(done); };

    EXPECT_EQ(run_pool(pool, {}).value(), 4);

    const std::string text = *read_text_file(name);
    for (const char* chunk : {"0-1\n", "2-3\n", "4-4\n"}) EXPECT_THAT(text, HasSubstr(chunk));
    EXPECT_EQ(text.size(), 12u);
    EXPECT_EQ(progress.size(), 3u);
    EXPECT_EQ(progress.back(), 5u);
  }
  ProcessPool pool = pool_of("", 2);
  pool.command = [](std::size_t, std::size_t) { return std::vector<std::string>{"/no/such/program"}; };
  EXPECT_EQ(run_pool(pool, {}).error().code, ErrorCode::not_found);
}

TEST(ProcessPool, EndsItsChildrenWhenAskedToStop) {
  // Every child would run for an hour; the first that is there asks for the end of all.
  const TemporaryFolder folder;
  const auto pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::stop_source stop;
  const std::jthread asks([&] {
    std::ifstream reads(pipe);
    reads.get();
    stop.request_stop();
  });

  EXPECT_EQ(run_pool(pool_of("echo > " + pipe.string() + "; exec sleep 3600", 1), stop.get_token()).value(), 130);
  EXPECT_EQ(run_pool(pool_of("exec sleep 3600", 2), stop.get_token()).value(), 130) << "nothing is started any more";
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
