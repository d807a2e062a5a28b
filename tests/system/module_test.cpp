// SPDX-License-Identifier: GPL-3.0-or-later
// Modules in plans and sensor files, as a user runs them: what changes nothing, what breaks in the middle of a run.
#include <cmath>
#include <numbers>

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

/// A contrast of 4 K with a limit that the acuity does not clearly meet.
std::string at_4_k(std::string plan) {
  const std::string key = "delta_t_k = [16.9]";
  plan.replace(plan.find(key), key.size(), "delta_t_k = [4]");
  return plan + "[[limits.acuity]]\ndelta_t_k = 4\nleast_acuity_per_mrad = 0.49\n";
}

TEST_F(Modules, ThatAreAGainAndAnOffsetChangeNoAcuityAndNoVerdict) {
  // Whole counts behind a gain of 0.3 are half of the noise; hvs-1 has ten times as much of its own.
  const std::vector<std::string> stages = {"identity", "affine=0.3,0", "affine=3,0", "affine=0.3,4000",
                                           "affine=1,-2000"};
  for (const std::string& command : {std::string("simulate"), std::string("measure")}) {
    std::vector<Json> points;
    for (const std::string& stage : stages) {
      const std::string name = command + std::to_string(points.size());
      const std::string section = module_section(stage);
      folder_.write(name + ".toml", at_4_k(command == "measure" ? small_measurement(6, section)
                                                                : small_plan(6, "phases = 6\n" + section)));
      const Ended ended = run({command, "./" + name + ".toml", "--out", name, "--json"});
      ASSERT_TRUE(completed(ended)) << stage;
      const Json json = one_object(ended);
      points.push_back(json["points"][0]);
      points.back()["decision"] = json["verdict"];
    }
    for (std::size_t i = 1; i < stages.size(); ++i) {
      EXPECT_EQ(points[i]["decision"], points[0]["decision"]) << command << " " << stages[i];
      EXPECT_NEAR(points[i]["acuity_per_mrad"].get<double>() / points[0]["acuity_per_mrad"].get<double>(), 1, 0.02)
          << command << " " << stages[i];
      EXPECT_EQ(points[i]["adequacy"], points[0]["adequacy"]) << command << " " << stages[i];
    }
  }
}

TEST_F(Modules, ThatCutOffByThemselvesLeaveNoVerdict) {
  // The surround is at 5000 counts, the triangles at 5400; 16383 is the end of the counts.
  for (const std::string& stage : {std::string("ceiling=5100"), std::string("affine=3.2,0")}) {
    folder_.write(stage + ".toml", at_4_k(small_plan(6, "phases = 6\n" + module_section(stage))));
    const Ended ended = run({"simulate", "./" + stage + ".toml", "--out", stage, "--json"});

    EXPECT_EQ(ended.code, 3) << stage << ended.err;
    const Json json = one_object(ended);
    EXPECT_EQ(json["verdict"], "inconclusive") << stage;
    EXPECT_THAT(json["points"][0]["adequacy"].dump(), HasSubstr("\"clipping\"")) << stage;
  }
}

TEST_F(Modules, ThatCutOffLeaveNoAcuityInTheHistory) {
  folder_.write("fine.toml", at_4_k(small_measurement(6, module_section("identity"))));
  folder_.write("cut.toml", at_4_k(small_measurement(6, module_section("ceiling=5100"))));
  for (const std::string& name : {std::string("fine"), std::string("cut")}) {
    ASSERT_TRUE(completed(run({"measure", "./" + name + ".toml", "--out", name})));
    EXPECT_EQ(run({"history", "add", name, "--index", name + ".sqlite"}).code, 0);
  }

  EXPECT_THAT(run({"history", "export", "--index", "fine.sqlite"}).out, HasSubstr(",acuity,"));
  EXPECT_THAT(run({"history", "export", "--index", "cut.sqlite"}).out, ::testing::Not(HasSubstr(",acuity,")));
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

  folder_.write("scan.toml", "[[stage]]\nkind = \"super-resolution\"\nshifts = \"scan\"\n");
  const Ended at_rest = run({"enhance", "m", "--packages", "scan.toml", "--out", "s"});
  EXPECT_EQ(at_rest.code, 6) << at_rest.err;
  EXPECT_THAT(at_rest.err, HasSubstr("the frames do not follow the scan"));
}

TEST_F(Modules, AndPackagesAreComparedOnTheFramesOfACameraThatIsMeasuredForThem) {
  folder_.write("plan.toml", small_measurement(4));
  folder_.write("slow.toml", "[[stage]]\nkind = \"recursive\"\nshare = 0.25\n");

  const Ended ended = run({"enhance", "./plan.toml", "--live", "--packages", "slow.toml", "--out", "e", "--json"});

  ASSERT_EQ(ended.code, 0) << ended.err;
  const Json json = one_object(ended);
  EXPECT_TRUE(same_content(at("e") / "session" / "trials.csv", at("e") / "trials-0.csv"));
  EXPECT_EQ(json["results"][1]["trials"], json["results"][0]["trials"]);
  EXPECT_TRUE(json["warnings"].empty()) << "the camera was given the time that the filter needs to forget";
  EXPECT_FALSE(std::filesystem::is_empty(at("e") / "session" / "frames"));
  expect_refused(run({"enhance", "e/session", "--live", "--packages", "slow.toml", "--out", "no"}), 2, "--live");
  folder_.write("simulated.toml",
                "name = \"simulated\"\n[target]\nkind = \"scene\"\ndistance_m = 2\nplates = [\"tcat-a\"]\n");
  expect_refused(run({"enhance", "./simulated.toml", "--live", "--packages", "slow.toml", "--out", "no"}), 2, "camera");
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

/// The SC2000 with detectors of a pitch, as a program where `section` says so.
std::string full_pitch_sensor(const std::string& section) {
  std::string sensor = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  const std::string key = "detector_um = 42.5";
  return sensor.replace(sensor.find(key), key.size(), "detector_um = 47.5") + section;
}
std::string sensor_section(const std::string& arguments, const std::string& more = "") {
  return "[[module]]\nplace = \"sensor\"\ncommand = \"" + example + " sensor " + arguments + "\"\n" + more;
}

TEST_F(Modules, ThatAreTheSensorHaveTheAcuityAndTheTransferOfTheBuiltInOne) {
  folder_.write("built-in.toml", full_pitch_sensor(""));
  folder_.write("program.toml", full_pitch_sensor(sensor_section("identity")));
  const auto simulated = [&](const std::string& name) {
    folder_.write(name + "-plan.toml", small_plan(2, "phases = 10\nsensor = \"./" + name +
                                                         ".toml\"\nskip = [\"diffraction\"]\n[fit]\nestimator = "
                                                         "\"weibull\"\n"));
    const Ended ended = run({"simulate", "./" + name + "-plan.toml", "--out", name, "--json"});
    EXPECT_TRUE(completed(ended)) << ended.err;
    return one_object(ended)["points"][0];
  };

  const Json built_in = simulated("built-in"), program = simulated("program");
  folder_.write("plan.toml", small_plan(2, "phases = 2\n"));
  const Ended compared =
      run({"compare-models", "./built-in.toml", "./program.toml", "--plan", "./plan.toml", "--out", "c", "--json"});

  // The noise is other noise: each lies in the interval of the other.
  for (const auto& [one, other] : {std::pair(&built_in, &program), std::pair(&program, &built_in)}) {
    EXPECT_GT((*one)["s75_mrad"], (*other)["s75_ci95_mrad"][0]);
    EXPECT_LT((*one)["s75_mrad"], (*other)["s75_ci95_mrad"][1]);
  }
  const Json record = Json::parse(content_of(at("program") / "provenance.json"));
  EXPECT_EQ(record["modules"][0]["place"], "sensor");
  // Two phases are too few for thresholds that are fit for a decision.
  ASSERT_EQ(compared.code, 3) << compared.err;
  const Json models = one_object(compared);
  EXPECT_TRUE(models["pixels"][0]["rms_k"].is_null()) << "a program shows no signal without its noise";
  EXPECT_LT(models["pixels"][1]["rms_k"], 0.5);
  for (const Json& point : models["transfer"]) {
    const double f = point["frequency_per_mrad"].get<double>() * 47.5 / 36.3, x = std::numbers::pi * f;
    EXPECT_NEAR(point["b"].get<double>(), f > 0 ? std::abs(std::sin(x) / x) : 1.0, 2e-4) << f;
  }
}

TEST_F(Modules, ThatAreTheSensorAndBreakAreNamedAndTheTrialsKept) {
  // The response takes 36 frames of a process of its own, the run 32 and 16 before its first presentation.
  const struct {
    const char* name;
    std::string arguments, more, sentence;
    int code;
    bool trials;
  } cases[] = {{"ends", "ends 49", "", "that is enough", 5, true},
               {"nan", "nan 49", "", "not finite", 5, true},
               {"shape", "shape 49", "", "shape", 5, true},
               {"text", "text 49", "", "not a .npy array", 5, true},
               {"hang", "hang 49", "limit_ms = 3000\n", "3000 ms", 5, true},
               {"endless", "endless", "", "", 5, false}};
  for (const auto& [name, arguments, more, sentence, code, trials] : cases) {
    folder_.write("sensor.toml", full_pitch_sensor(sensor_section(arguments, more)));
    const Ended ended = simulate(name, "sensor = \"./sensor.toml\"\n");

    EXPECT_EQ(ended.code, code) << name << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(sentence)) << name;
    EXPECT_THAT(ended.err, HasSubstr(example)) << name;
    const auto rows = rows_in(at(name) / "trials.csv");
    EXPECT_TRUE(trials ? rows > 0 && rows < 40 : rows == 0) << name << " " << rows;
  }
  EXPECT_THAT(content_of(at("ends") / "log.txt"), HasSubstr("module: that is enough"));
}

TEST_F(Modules, ThatAreTheSensorAreRefusedInASentenceWhereTheyCannotBe) {
  folder_.write("sensor.toml", full_pitch_sensor(sensor_section("identity")));
  folder_.write("second.toml", full_pitch_sensor(module_section("identity") + sensor_section("identity")));
  const auto refusal = [&](const std::string& more, const std::string& sentence) {
    folder_.write("bad.toml", small_plan(1, "sensor = \"./sensor.toml\"\n" + more));
    expect_refused(run({"simulate", "./bad.toml", "--out", "bad"}), 2, sentence);
  };
  refusal("microscan = 2\n", "microscan");
  refusal("[measures]\nnoise = true\n", "[measures]");
  refusal("[[module]]\nplace = \"sensor\"\ncommand = \"cat\"\n", "place");
  expect_refused(run({"simulate", "--sensor", "./second.toml", "--out", "bad"}), 2, "first");
  folder_.write("good.toml", small_plan(1, "sensor = \"./sensor.toml\"\n"));
  expect_refused(run({"plan", "./good.toml"}), 2, "[[module]]");
  const Ended kept = run({"module", "check", example + " sensor identity", "--place", "sensor", "--json"});
  const Ended broken = run({"module", "check", example + " sensor shape", "--place", "sensor"});

  ASSERT_EQ(kept.code, 0) << kept.err;
  const Json json = one_object(kept);
  EXPECT_NEAR(json["response"].get<double>(), 1, 1e-6);
  // 3072 pixels: a relative standard error of 1 / sqrt(2 * 3072) = 1.3 %.
  EXPECT_NEAR(json["noise_k"].get<double>() / 0.07, 1, 0.05);
  EXPECT_TRUE(json["linear"]);
  EXPECT_EQ(broken.code, 5) << broken.err;
}

TEST_F(Modules, ThatBreakInTheMiddleOfARunAreNamedAndTheTrialsKept) {
  // Registration takes 32 frames, the contrast 16, a presentation one: the second fails. 20 triangles a presentation.
  const struct {
    const char* name;
    std::string arguments, more, sentence;
  } cases[] = {{"ends", "ends 49", "", "that is enough"},
               {"nan", "nan 49", "", "not finite"},
               {"shape", "shape 49", "", "shape"},
               {"text", "text 49", "", "not a .npy array"},
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
  refusal("[[module]]\ncommand = \"\"\n", "found an empty text");
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
  // Trials of the plate at rest: twenty triangles in each of four passes a contrast; of all, two speeds, four
  // observers.
  EXPECT_EQ(rows_in(at("trials.csv")), 80 * json["contrasts"].size());
  EXPECT_EQ(rows_in(at("moving-trials.csv")), 8 * 80 * json["contrasts"].size());
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
  expect_refused(run({"dynamic", "./fast.toml"}), 2, "pixels per frame");
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

  const Ended linear = run({"--json", "--out", "linear"});
  const Ended equalised = run({"--package", "equalised.toml", "--json", "--out", "equalised"});

  EXPECT_EQ(linear.code, 0) << linear.err;
  EXPECT_EQ(one_object(linear)["verdict"], "independent");
  EXPECT_EQ(equalised.code, 1) << equalised.err;
  EXPECT_EQ(one_object(equalised)["verdict"], "depends");
  expect_refused(todbench({"scene-dependence", "./plan.toml", "--cycles", "2"}, {.folder = folder.path()}), 2, "");

  // Sessions as others, but for the curve.
  const auto say = [&](const std::vector<std::string>& arguments) {
    return todbench(arguments, {.folder = folder.path()});
  };
  EXPECT_EQ(one_object(linear)["judgement"]["decision"], "pass");
  EXPECT_EQ(one_object(equalised)["judgement"]["decision"], "fail");
  const Json demand = one_object(equalised)["judgement"]["demands"][0];
  EXPECT_NEAR(demand["result"].get<double>(), 100 * (1 / one_object(equalised)["sizes"][0]["ratio"].get<double>() - 1),
              3)
      << "a gain control changes all sizes alike";
  EXPECT_GT(demand["interval"][0].get<double>(), demand["limit"].get<double>());
  for (const char* name : {"linear", "equalised"}) {
    const auto session = folder.path() / name;
    EXPECT_EQ(say({"verify", name}).code, 0);
    const std::string page = content_of(session / "report.html");
    std::filesystem::remove(session / "report.html");
    EXPECT_EQ(say({"report", name}).code, 0);
    EXPECT_TRUE(content_of(session / "report.html") == page);
    EXPECT_EQ(say({"verify", name}).code, 0);
    EXPECT_TRUE(std::filesystem::exists(session / "pictures" / "main-bar_in.png"));
    EXPECT_FALSE(std::filesystem::exists(session / "curve.csv"));
  }
  EXPECT_EQ(content_of(folder.path() / "equalised" / "inputs" / "package.toml"),
            content_of(folder.path() / "equalised.toml"));
  const Ended added = say({"history", "add", ".", "--index", "h.sqlite", "--json"});
  EXPECT_EQ(added.code, 0) << added.out;
  EXPECT_EQ(one_object(added)["added"], 2);
  EXPECT_THAT(say({"history", "export", "--index", "h.sqlite"}).out, ::testing::HasSubstr("scene_ratio"));
  expect_refused(say({"compare", "linear", "equalised"}), 2, "");
  expect_refused(say({"range", "--tod", "linear", "--size-m", "2", "--delta-t-k", "2"}), 2, "");
}

}  // namespace
}  // namespace todbench::testing
