// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps, effect decisions, modules and packages as a user runs them.
#include <fstream>
#include <map>

#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

TEST(SweepCommand, HasTheSameTableHoweverItWasRun) {
  const TemporaryFolder folder;
  const std::string sweep =
      "kind = \"estimate\"\n[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n[grid]\nnetd_k = [0.07, 0.4]\n"
      "detector_um = [30, 42.5]\n[repeat]\nseeds = 2\n";
  const auto in = [&](const std::string& part, std::vector<std::string> more, const ChildOptions& options = {}) {
    more.insert(more.begin(), {"sweep", part, "s.toml"});
    ChildOptions there = options;
    if (there.folder.empty()) there.folder = folder.path() / "a";
    return todbench(more, there);
  };
  folder.write("a/s.toml", sweep);
  folder.write("b/s.toml", sweep);
  folder.write("c/s.toml", sweep);

  EXPECT_EQ(one_object(in("expand", {"--json"}))["tasks"], 8);
  EXPECT_EQ(in("collect", {}).code, 3) << "nothing is there yet";
  EXPECT_EQ(in("run", {"--range", "0-2"}).code, 0);
  EXPECT_EQ(one_object(in("status", {"--json"}))["open"], "3-7");
  EXPECT_EQ(in("run", {}).code, 0);
  EXPECT_EQ(in("run", {"--jobs", "3", "--chunk", "1"}, {.folder = folder.path() / "b"}).code, 0);
  for (const char* index : {"3", "1", "0", "2"}) {
    const Ended job =
        in("run", {"--chunk", "2"}, {.folder = folder.path() / "c", .setenv = {{"SLURM_ARRAY_TASK_ID", index}}});
    EXPECT_EQ(job.code, 0) << job.err;
  }
  for (const char* part : {"a", "b", "c"}) EXPECT_EQ(in("collect", {}, {.folder = folder.path() / part}).code, 0);

  const std::string table = content_of(folder.path() / "a/s.results/table.csv");
  EXPECT_THAT(table, HasSubstr("netd_k,detector_um,repeat,seed"));
  EXPECT_EQ(content_of(folder.path() / "b/s.results/table.csv"), table);
  EXPECT_EQ(content_of(folder.path() / "c/s.results/table.csv"), table);
  const Json json = one_object(in("collect", {"--json"}));
  EXPECT_EQ(json["rows"].size(), 8u);
  EXPECT_EQ(json["effects"][0]["parameters"][0]["key"], "netd_k");
  EXPECT_EQ(in("collect", {"--page", "page.html"}).code, 0);
  EXPECT_THAT(content_of(folder.path() / "a/page.html"), HasSubstr("</html>"));
}

TEST(EffectDecisions, AreStatedByEveryCommandThatSimulatesWithoutSimulating) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(8));
  folder.write("p.toml", "[[stage]]\nkind = \"median\"\n");
  folder.write("noisy.toml", content_of(source_file("sim_devices/sensors/sc2000.toml")) +
                                 "\nhalo_share = 0.02\nhalo_sigma_pitch = 10\n");
  const std::vector<std::vector<std::string>> commands{
      {"enhance", "./plan.toml", "--packages", "p.toml"},
      {"identify", "small-craft", "--sensor", "sc2000", "--ranges", "100,200"},
      {"mrtd", "--sensor", "sc2000"},
      {"picture", "craft-at-sea", "--sensor", "sc2000", "--range-m", "300", "--out", "pictures", "--accuracy", "draft"},
      {"dynamic", "--speeds-mrad-s", "5"}};
  for (std::vector<std::string> command : commands) {
    const std::string name = command.front();
    command.emplace_back("--dry-run");
    const Ended said = todbench(command, {.folder = folder.path()});
    command.emplace_back("--why");
    const Ended why = todbench(command, {.folder = folder.path()});
    command.emplace_back("--json");
    const Ended json = todbench(command, {.folder = folder.path()});

    ASSERT_EQ(said.code, 0) << name << said.err;
    ASSERT_EQ(json.code, 0) << name << json.err;
    const auto decisions = decisions_of(one_object(json)["effects"]);
    EXPECT_EQ(decisions.at("diffraction"), "simulate") << name;
    EXPECT_EQ(decisions.at("halo"), "skip") << name;
    EXPECT_THAT(said.out, HasSubstr("neutral in this sensor, so skipped without a change")) << name;
    EXPECT_LT(said.out.find("diffraction"), said.out.find("halo")) << name << ": decided effects come first";
    EXPECT_EQ(why.out.find("neutral in this sensor, so skipped"), std::string::npos) << name;
    EXPECT_GT(occurrences(why.out, "\n"), occurrences(said.out, "\n")) << name;
    EXPECT_THAT(said.out, HasSubstr(one_object(json)["promise"].get<std::string>())) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "pictures"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "enhancement"));
  const Json models = one_object(
      todbench({"compare-models", "sc2000", "./noisy.toml", "--dry-run", "--json"}, {.folder = folder.path()}));
  EXPECT_EQ(decisions_of(models["models"][0]["effects"]).at("halo"), "skip");
  EXPECT_EQ(decisions_of(models["models"][1]["effects"]).at("halo"), "simulate");
}

TEST(EffectDecisions, OfAMovingTargetKeepTheToleranceAtRestAndInMotion) {
  const auto acuities = [](const std::vector<std::string>& more) {
    std::vector<std::string> command{"dynamic", "--speeds-mrad-s", "3", "--delta-t-k", "1.93",  "--passes",
                                     "24",      "--frames",        "2", "--accuracy",  "draft", "--json"};
    command.insert(command.end(), more.begin(), more.end());
    return one_object(todbench(command));
  };
  const Json every = acuities({}), planned = acuities({"--tolerance-percent", "2"});

  EXPECT_THAT(planned["promise"].get<std::string>(), HasSubstr("2 % are allowed"));
  int skipped = 0;
  for (const auto& effect : planned["effects"])
    skipped += effect["decision"] == "skip" && effect["predicted_change_percent"] != 0 ? 1 : 0;
  EXPECT_GT(skipped, 0);
  ASSERT_EQ(every["speeds"].size(), planned["speeds"].size());
  expect_refused(todbench({"dynamic", "--speeds-mrad-s", "3", "--tolerance-percent", "1", "--package",
                           source_file("docs/examples/packages/sharpen.toml")}),
                 2, "sensor alone");
}

TEST(SweepCommand, EndsWithACodeOfItsOwnWhereAnotherProcessHoldsATask) {
  const TemporaryFolder folder;
  folder.write("s.toml",
               "kind = \"estimate\"\n[base]\naccuracy = \"draft\"\ndelta_t_k = [16.9]\n[grid]\nnetd_k = [0.07]\n");
  const auto run = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"sweep", "run", "s.toml"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench(arguments, {.folder = folder.path()});
  };
  ASSERT_EQ(run({}).code, 0);
  // The result becomes a lock of another host, whose process cannot be asked.
  std::filesystem::path result;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path() / "s.results")) {
    if (entry.is_regular_file() && entry.path().extension() == ".json") result = entry.path();
  }
  ASSERT_FALSE(result.empty());
  std::filesystem::remove(result);
  std::ofstream(result.replace_extension(".lock")) << "a-host-that-is-not-this-one\n1\n";

  const Ended held = run({"--json"}), in_processes = run({"--jobs", "2", "--json"});

  EXPECT_EQ(held.code, 4) << held.err;
  EXPECT_EQ(one_object(held)["locked"], 1);
  EXPECT_EQ(in_processes.code, 4) << in_processes.err;
  EXPECT_EQ(one_object(in_processes),
            one_object(todbench({"sweep", "status", "s.toml", "--json"}, {.folder = folder.path()})));
}

TEST(SweepCommand, PrintsTaskListsAndRefusesInASentence) {
  const TemporaryFolder folder;
  folder.write("s.toml", "[grid]\nnetd_k = [0.03, 0.05]\n[repeat]\nseeds = 2\n");
  folder.write("bad.toml", "[grid]\nnetd = [0.03]\n");
  const auto run = [&](const std::vector<std::string>& arguments) {
    return todbench(arguments, {.folder = folder.path()});
  };

  EXPECT_EQ(lines_of(run({"sweep", "tasks", "s.toml", "--for", "parallel"}).out).size(), 4u);
  EXPECT_THAT(run({"sweep", "tasks", "s.toml", "--for", "slurm"}).out, HasSubstr("--array=0-3"));
  EXPECT_EQ(run({"sweep", "submit", "s.toml", "--engine", "slurm", "--dry-run", "--quiet"}).code, 0);
  EXPECT_THAT(content_of(folder.path() / "s.results/slurm.sh"), HasSubstr("#SBATCH --array=0-3"));
  expect_refused(run({"sweep", "expand", "bad.toml"}), 2, "unknown parameter 'netd'");
  expect_refused(run({"sweep", "expand", "none.toml"}), 2, "none.toml");
  expect_refused(run({"sweep", "run", "s.toml", "--range", "9-3"}), 2, "--range");
  expect_refused(run({"sweep", "run", "s.toml", "--index", "4"}), 2, "is too large");
  expect_refused(run({"sweep"}), 2, "sweep");
}

TEST(ModuleCommand, EndsWithFiveWhereAProgramBreaksTheContract) {
  expect_refused(todbench({"module", "check", "/no/such/program"}), 5, "ended before it answered");
  // It sends the header back, which is no picture.
  expect_refused(todbench({"module", "check", "cat"}), 5, "shape");
  const Ended silent = todbench({"module", "check", "sleep 60", "--limit-ms", "200", "--json"});
  EXPECT_EQ(silent.code, 5);
  EXPECT_EQ(one_object(silent)["ok"], false);
}

TEST(EnhanceCommand, NamesAPackageThatFailsAndKeepsTheOthers) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(2));
  folder.write("good.toml", "[[stage]]\nkind = \"sharpen\"\namount = 0\n");
  folder.write("dead.toml", "[[stage]]\nkind = \"module\"\ncommand = \"echo no licence >&2\"\n");
  const auto enhance = [&](std::vector<std::string> more) {
    more.insert(more.begin(), "enhance");
    return todbench(more, {.folder = folder.path()});
  };

  const Ended ended = enhance({"plan.toml", "--packages", "dead.toml", "good.toml", "--out", "e", "--json"});

  EXPECT_EQ(ended.code, 5) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("no licence"));
  const Json json = one_object(ended);
  ASSERT_EQ(json["results"].size(), 3u);
  EXPECT_TRUE(json["results"][1]["error"].is_string());
  EXPECT_TRUE(json["results"][2]["error"].is_null());
  EXPECT_EQ(json["results"][2]["points"][0]["acuity_per_mrad"], json["results"][0]["points"][0]["acuity_per_mrad"]);
  EXPECT_THAT(content_of(folder.path() / "e/enhancement.html"), HasSubstr("</html>"));
  EXPECT_EQ(rows_in(folder.path() / "e/trials-2.csv"), json["results"][0]["trials"].get<std::size_t>());
  EXPECT_THAT(content_of(folder.path() / "e/package-1.log"), HasSubstr("no licence"));
  expect_refused(enhance({"plan.toml", "--packages", "good.toml", "--out", "e"}), 2, "not empty");
  expect_refused(enhance({"plan.toml", "--packages", "none.toml"}), 2, "none.toml");
  expect_refused(enhance({"none.toml", "--packages", "good.toml"}), 2, "none.toml");
}

}  // namespace
}  // namespace todbench::testing
