// Modules in plans and sensor files, as a user runs them: what changes nothing, what breaks in the middle of a run.
#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;

const std::string example = TODBENCH_MODULE_EXAMPLE;

std::string module_section(const std::string& arguments, const std::string& more = "") {
  return "[[module]]\ncommand = \"" + example + " " + arguments + "\"\n" + more;
}

class Modules : public ::testing::Test {
 protected:
  Ended run(const std::vector<std::string>& arguments) const { return todbench(arguments, {.folder = folder_.path()}); }
  /// Simulates the small plan with a module into the folder `name`.
  Ended simulate(const std::string& name, const std::string& section) {
    folder_.write(name + ".toml", small_plan(2, "phases = 2\n" + section));
    return run({"simulate", "./" + name + ".toml", "--out", name, "--json"});
  }
  std::filesystem::path at(const std::string& name) const { return folder_.path() / name; }
  TemporaryFolder folder_;
};

TEST_F(Modules, ThatChangeNothingLeaveEveryAnswerAsItIs) {
  folder_.write("plain.toml", small_measurement(2));
  folder_.write("with.toml", small_measurement(2, module_section("identity")));

  const Ended plain = run({"measure", "./plain.toml", "--out", "plain"});
  const Ended with = run({"measure", "./with.toml", "--out", "with"});

  ASSERT_TRUE(completed(plain));
  ASSERT_TRUE(completed(with));
  EXPECT_TRUE(same_content(at("plain") / "trials.csv", at("with") / "trials.csv"));
  EXPECT_EQ(rows_in(at("with") / "trials_simulated.csv"), rows_in(at("with") / "trials.csv"));
  const Json record = Json::parse(content_of(at("with") / "provenance.json"));
  ASSERT_EQ(record["modules"].size(), 1u);
  EXPECT_EQ(record["modules"][0]["command"], example + " identity");
  EXPECT_EQ(record["modules"][0]["files"][example].get<std::string>().size(), 64u);
  EXPECT_THAT(content_of(at("with") / "report.html"), HasSubstr("Module (picture)"));
}

TEST_F(Modules, OfASessionRunInAReplayOnlyWhereTheyAreAllowedTo) {
  folder_.write("plan.toml", small_measurement(2, "[measurement]\nrecord_frames = true\n" +
                                                      module_section("double", "parameters = { strength = \"2\" }\n")));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--out", "m"})));

  expect_refused(run({"replay", "m", "--out", "no"}), 2, "--run-modules");
  const Ended replayed = run({"replay", "m", "--run-modules", "--out", "yes"});

  EXPECT_TRUE(completed(replayed));
  EXPECT_TRUE(same_content(at("m") / "trials.csv", at("yes") / "trials.csv"));
}

TEST_F(Modules, AndPackagesAreComparedOnTheRecordedFramesOfASession) {
  folder_.write("plan.toml", small_measurement(4, "[measurement]\nrecord_frames = true\n"));
  ASSERT_TRUE(completed(run({"measure", "./plan.toml", "--out", "m"})));
  folder_.write("same.toml", "[[stage]]\nkind = \"module\"\ncommand = \"" + example + " identity\"\n");
  folder_.write("slow.toml", "[[stage]]\nkind = \"recursive\"\nshare = 0.25\n");

  const Ended ended = run({"enhance", "m", "--packages", "same.toml", "slow.toml", "--out", "e", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_TRUE(same_content(at("m") / "trials.csv", at("e") / "trials-0.csv"));
  EXPECT_TRUE(same_content(at("m") / "trials.csv", at("e") / "trials-1.csv"));
  EXPECT_EQ(json["results"][2]["trials"], json["results"][0]["trials"]);
  EXPECT_EQ(json["warnings"].size(), 1u) << "the filter remembers longer than the run left out";
  expect_refused(run({"enhance", ".", "--packages", "same.toml", "--out", "no"}), 2, "");
}

TEST_F(Modules, ThatAreTheObserverGiveTheAnswersOfTheBuiltInOne) {
  const Ended built_in = simulate("built-in", module_section("identity"));
  const Ended module = simulate("module", module_section("hvs", "place = \"observer\"\nversion = \"echo 1.5\"\n"));

  ASSERT_TRUE(completed(built_in));
  ASSERT_TRUE(completed(module));
  EXPECT_TRUE(same_content(at("built-in") / "trials.csv", at("module") / "trials.csv"));
  const Json record = Json::parse(content_of(at("module") / "provenance.json"));
  EXPECT_EQ(record["modules"][0]["place"], "observer");
  EXPECT_EQ(record["modules"][0]["version"], "1.5");
}

TEST_F(Modules, OfASensorFileAreBehindItsPictures) {
  const std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  folder_.write("same.toml", sensor + module_section("identity"));
  folder_.write("twice.toml", sensor + module_section("double"));

  const Ended same =
      run({"simulate", "--sensor", "./same.toml", "--delta-t-k", "16.9", "--accuracy", "draft", "--out", "s"});
  const Ended elsewhere = run({"mtf", "--sensor", "./same.toml"});

  EXPECT_TRUE(completed(same));
  EXPECT_EQ(Json::parse(content_of(at("s") / "provenance.json"))["modules"].size(), 1u);
  EXPECT_EQ(elsewhere.code, 2) << "a transfer function without the module would be that of another camera";
}

TEST_F(Modules, ThatBreakInTheMiddleOfARunAreNamedAndTheTrialsKept) {
  // Registration takes 32 frames, the contrast 16, a presentation one: the second fails. 20 triangles a presentation.
  const struct {
    const char* name;
    std::string arguments, more, sentence;
  } cases[] = {{"ends", "ends 49", "", "that is enough"},
               {"nan", "nan 49", "", "not finite"},
               {"shape", "shape 49", "", "shape"},
               {"text", "text 49", "", "no .npy array"},
               {"hang", "hang 49", "limit_ms = 3000\n", "3000 ms"},
               {"scores", "hvs nan 25", "place = \"observer\"\n", "not finite"},
               {"few", "hvs shape 25", "place = \"observer\"\n", "shape"}};
  for (const auto& [name, arguments, more, sentence] : cases) {
    const Ended ended = simulate(name, module_section(arguments, more));

    EXPECT_EQ(ended.code, 5) << name << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(sentence)) << name;
    EXPECT_THAT(ended.err, HasSubstr(example)) << name;
    const auto rows = rows_in(at(name) / "trials.csv");
    EXPECT_TRUE(rows > 0 && rows < 40) << name << " " << rows;
    EXPECT_EQ(Json::parse(content_of(at(name) / "provenance.json"))["state"], "interrupted") << name;
  }
  EXPECT_THAT(content_of(at("ends") / "log.txt"), HasSubstr("module: that is enough"));
}

TEST_F(Modules, AreRefusedInASentenceWhereTheyCannotBe) {
  const auto refusal = [&](const std::string& section, const std::string& sentence) {
    folder_.write("bad.toml", small_plan(1, section));
    expect_refused(run({"simulate", "./bad.toml", "--out", "bad"}), 2, sentence);
  };
  refusal("[[module]]\ncommand = \"\"\n", "is empty");
  refusal("[[module]]\nplace = \"picture\"\n", "command");
  refusal("[[module]]\ncommand = \"cat\"\nplace = \"air\"\n", "place");
  refusal("[schedule]\nanswers = \"graded\"\n" + module_section("hvs", "place = \"observer\"\n"), "graded");
  refusal(module_section("hvs", "place = \"observer\"\n") + module_section("hvs", "place = \"observer\"\n"), "second");
  folder_.write("bad.toml", small_plan(1, module_section("identity")));
  expect_refused(run({"plan", "./bad.toml"}), 2, "[[module]]");
}

TEST(DynamicCommand, MeasuresAPlanThatMovesAndRefusesInASentence) {
  const TemporaryFolder folder;
  folder.write("moving.toml",
               small_plan(1, "[motion]\nspeeds_mrad_s = [30]\npasses = 4\nframes = 2\nlead_frames = 1\n"));
  const auto run = [&](const std::vector<std::string>& arguments) {
    return todbench(arguments, {.folder = folder.path()});
  };

  const Ended ended = run({"dynamic", "./moving.toml", "--out", "moved", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  ASSERT_EQ(json["passes"].size(), 8u * json["contrasts"].size());
  EXPECT_EQ(json["contrasts"][0]["speeds"].size(), 2u);
  EXPECT_EQ(json["contrasts"][0]["speeds"][0]["points"][0]["ratio_to_static"].is_null() ||
                json["contrasts"][0]["speeds"][0]["points"][0]["ratio_to_static"] == 1,
            true);
  // A detector without memory: no lag, within a twentieth of a frame.
  EXPECT_NEAR(json["time_constant"]["time_constant_ms"].get<double>(), 0, 1);
  EXPECT_LT(json["residual_px"].get<double>(), 0.1);
  const auto at = [&](const char* name) { return folder.path() / "moved" / name; };
  EXPECT_EQ(Json::parse(content_of(at("dynamic.json")))["contrasts"], json["contrasts"]);
  EXPECT_EQ(Json::parse(content_of(at("provenance.json")))["state"], "complete");
  // Trials of the plate at rest: twenty triangles in each of four passes a contrast; of all, two speeds, three
  // observers.
  EXPECT_EQ(rows_in(at("trials.csv")), 80 * json["contrasts"].size());
  EXPECT_EQ(rows_in(at("moving-trials.csv")), 6 * 80 * json["contrasts"].size());
  EXPECT_EQ(run({"verify", "moved"}).code, 0);
  EXPECT_EQ(run({"report", "moved"}).code, 0);
  expect_refused(run({"dynamic", "./moving.toml", "--out", "moved"}), 2, "");
  folder.write("camera.toml",
               small_measurement(1, "[motion]\nspeeds_mrad_s = [30]\npasses = 4\nframes = 2\nlead_frames = 1\n"));
  EXPECT_EQ(run({"dynamic", "./camera.toml", "--out", "of-a-camera"}).code, 0);
  EXPECT_EQ(run({"history", "add", "of-a-camera", "--index", "index.sqlite"}).code, 0) << "a session as any other";
  folder.write("graded.toml", small_plan(1, "[schedule]\nanswers = \"graded\"\n[fit]\nestimator = \"twin-shape\"\n"));
  expect_refused(run({"dynamic", "./graded.toml", "--out", "graded"}), 2, "graded");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "graded"));
  expect_refused(run({"dynamic"}), 2, "--speeds-mrad-s");
  expect_refused(run({"dynamic", "./moving.toml", "--speeds-mrad-s", "3"}), 2, "");
  folder.write("fast.toml", small_plan(1, "[motion]\nspeeds_mrad_s = [9000]\n"));
  expect_refused(run({"dynamic", "./fast.toml"}), 2, "pixels a frame");
  folder.write("long.toml", content_of(source_file("sim_devices/sensors/sc2000.toml")) + "exposure_ms = 21\n");
  expect_refused(run({"dynamic", "--speeds-mrad-s", "3", "--sensor", "./long.toml"}), 2, "exposure_ms");
}

TEST(SceneDependenceCommand, SaysWhetherAHotBarMattersByItsExitCode) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1));
  folder.write("equalised.toml", "name = \"equalised\"\n[[stage]]\nkind = \"agc\"\nplateau_counts = 10\n");
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"scene-dependence", "./plan.toml", "--cycles", "3", "--frames", "4"});
    return todbench(arguments, {.folder = folder.path()});
  };

  const Ended linear = run({"--json"});
  const Ended equalised = run({"--package", "equalised.toml", "--json"});

  EXPECT_EQ(linear.code, 0) << linear.err;
  EXPECT_EQ(one_object(linear)["verdict"], "independent");
  EXPECT_EQ(equalised.code, 1) << equalised.err;
  EXPECT_EQ(one_object(equalised)["verdict"], "depends");
  expect_refused(todbench({"scene-dependence", "./plan.toml", "--cycles", "2"}, {.folder = folder.path()}), 2, "");
}

}  // namespace
}  // namespace todbench::testing
