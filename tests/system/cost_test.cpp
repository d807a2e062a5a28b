// SPDX-License-Identifier: GPL-3.0-or-later
// What accuracy costs, what a plan cannot reach, and sensors that cannot exist: as a user meets them.
#include <cmath>

#include "tests/support/source_file.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The points of one knob.
std::vector<Json> points_of(const Json& cost, const std::string& knob) {
  std::vector<Json> points;
  for (const auto& point : cost["points"]) {
    if (point["knob"] == knob) points.push_back(point);
  }
  return points;
}

TEST(Cost, MeasuresTheFrontierIntoAFigureAndOneObject) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1, "phases = 2\n"));

  const Ended ended =
      todbench({"cost", "./plan.toml", "--budget-s", "12", "--svg", "cost.svg", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 0) << ended.err;
  const Json cost = one_object(ended);
  EXPECT_EQ(keys_of(cost), (std::set<std::string>{"reference", "points", "budget_s", "spent_s", "notes", "frontier"}));
  EXPECT_EQ(cost["frontier"].size(), 5U) << "binary, and graded with 1, 2, 4 and 8 frames";
  for (const char* knob : {"planner", "trials", "tolerance", "draws", "wavelengths", "phases", "wrap", "band"})
    EXPECT_FALSE(points_of(cost, knob).empty()) << knob;
  int chosen = 0;
  for (const auto& point : cost["points"]) {
    // A number, or why there is none.
    EXPECT_NE(point["wall_s"].is_null(), point["not_measured"].is_null()) << point;
    EXPECT_EQ(point["wall_s"].is_null(), point["error_percent"].is_null()) << point;
    if (point["chosen"]) ++chosen;
  }
  EXPECT_EQ(chosen, 1);
  EXPECT_FALSE(points_of(cost, "planner").front()["wall_s"].is_null());
  const std::string figure = content_of(folder.path() / "cost.svg");
  EXPECT_THAT(figure, HasSubstr(">chosen<"));
  EXPECT_THAT(figure, HasSubstr("chosen: "));
}

TEST(Cost, OfASessionIsKeptThereAndShownInItsReport) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1, "phases = 2\n"));
  ASSERT_TRUE(completed(todbench({"simulate", "./plan.toml", "--out", "s"}, {.folder = folder.path()})));
  ASSERT_THAT(content_of(folder.path() / "s" / "report.html"), Not(HasSubstr("Cost of accuracy")));

  const Ended ended = todbench({"cost", "--session", "s", "--budget-s", "10", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(Json::parse(content_of(folder.path() / "s" / "cost.json")), one_object(ended));
  const std::string report = content_of(folder.path() / "s" / "report.html");
  EXPECT_THAT(report, HasSubstr("Cost of accuracy"));
  EXPECT_THAT(report, HasSubstr("id=\"cost-result-title\""));
  expect_whole_session(folder.path() / "s", "complete");
  // The report rebuilt from the folder alone is the same.
  ASSERT_EQ(todbench({"report", "s"}, {.folder = folder.path()}).code, 0);
  EXPECT_EQ(content_of(folder.path() / "s" / "report.html"), report);
}

TEST(Cost, OfAPlanWithoutThresholdIsInconclusive) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1).replace(small_plan(1).find("16.9"), 4, "0.001"));

  const Ended ended = todbench({"cost", "./plan.toml", "--json"}, {.folder = folder.path()});

  EXPECT_EQ(ended.code, 3) << ended.err;
  EXPECT_THAT(lines_of(ended.err).back(), HasSubstr("the plan has no identifiable threshold"));
  const Json cost = one_object(ended);
  EXPECT_TRUE(cost["points"].empty());
  EXPECT_THAT(cost["notes"].at(0).get<std::string>(), HasSubstr("at 0.001 K: no size up to 40 pitches"));
}

TEST(Cost, RefusesABudgetThatIsTooShort) {
  const TemporaryFolder folder;

  const Ended ended = todbench({"cost", "demo", "--budget-s", "0.1"}, {.folder = folder.path()});

  expect_refused(ended, 2, "a budget of 0.1 s is too short");
}

TEST(Cost, RefusesWhatItCannotTake) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1));
  const ChildOptions here{.folder = folder.path()};

  expect_refused(todbench({"cost"}, here), 2, "cost: PLAN.toml or --session is required");
  expect_refused(todbench({"cost", "dmeo"}, here), 2, "unknown plan 'dmeo', did you mean 'demo'?");
  expect_refused(todbench({"cost", "./plan.toml", "--session", "s"}, here), 2, "--session already provides the plan");
  expect_refused(todbench({"cost", "--session", "s"}, here), 2, "s: not a session folder");
  expect_refused(todbench({"cost", "./plan.toml", "--budget-s", "nan"}, here), 2,
                 "--budget-s: expected a number from 0.1 to 86400");
  expect_refused(todbench({"cost", "./plan.toml", "--budget-s", "-3"}, here), 2, "--budget-s: expected a number");
}

/// A tolerance of 0.05 % needs about a hundred thousand draws: the caps allow 8000.
std::string unreachable_plan() {
  std::string plan = small_plan(1, "phases = 1\ntolerance_percent = 0.05\n");
  return plan.replace(plan.find("draft"), 5, "normal");
}

TEST(ToleranceOutOfReach, IsRefusedWithTheBestThatIsReachableAndItsPrice) {
  const TemporaryFolder folder;
  folder.write("plan.toml", unreachable_plan());

  for (const std::vector<std::string>& command : {std::vector<std::string>{"plan", "./plan.toml"},
                                                  {"plan", "./plan.toml", "--json"},
                                                  {"cost", "./plan.toml"},
                                                  {"cost", "./plan.toml", "--json"},
                                                  {"simulate", "./plan.toml", "--out", "s"},
                                                  {"simulate", "./plan.toml", "--out", "s", "--json"}}) {
    const Ended ended = todbench(command, {.folder = folder.path()});

    EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
    expect_refused(ended, 2, "a tolerance of 0.05 % cannot be met at 16.9 K");
    EXPECT_THAT(ended.err, ::testing::ContainsRegex("reach about 0\\.[0-9]+ %, in about [0-9.]+ s over all contrasts"));
  }
}

TEST(ToleranceOutOfReach, IsRefusedBeforeAMeasurementOpensItsCamera) {
  const TemporaryFolder folder;
  folder.write("plan.toml", unreachable_plan() + "[camera]\nid = \"gige:127.0.0.1\"\nifov_mrad = 1.3085\n");

  const Ended ended = todbench({"measure", "./plan.toml", "--out", "s"}, {.folder = folder.path()});

  EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
  expect_refused(ended, 2, "a tolerance of 0.05 % cannot be met at 16.9 K");
}

TEST(ToleranceOutOfReach, IsNamedForTheWorstContrastHoweverSmallItIs) {
  for (const std::string tolerance : {"1e-9", "0.05"}) {
    const Ended ended = todbench({"plan", "demo", "--accuracy", "auto", "--tolerance-percent", tolerance}, {});

    expect_refused(ended, 2, "% cannot be met at 0.23 K: the maximum of 8000 noise draws per size can reach about ");
  }
}

TEST(PlanWithoutThreshold, IsInconclusiveAndSaysWhyInEveryCommand) {
  // 2 mK before 70 mK of noise: no size has a threshold, nor is the plate found.
  const TemporaryFolder folder;
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"plan", "--sensor", "sc2000", "--delta-t-k", "0.002", "./plan.toml"},
        {"cost", "./plan.toml"},
        {"simulate", "./plan.toml", "--out", "s"}}) {
    std::string plan = small_plan(1, "phases = 1\n");
    folder.write("plan.toml", plan.replace(plan.find("16.9"), 4, "0.002"));

    const Ended ended = todbench(command, {.folder = folder.path()});

    EXPECT_EQ(ended.code, 3) << command.front() << ": " << ended.err;
    EXPECT_THAT(ended.err, ::testing::HasSubstr("the plan has no identifiable threshold")) << command.front();
  }
}

TEST(ToleranceOutOfReach, IsMetAtWhatTheRefusalNames) {
  const TemporaryFolder folder;
  folder.write("plan.toml", unreachable_plan());
  const std::string refusal = todbench({"plan", "./plan.toml"}, {.folder = folder.path()}).err;
  const std::size_t at = refusal.find("reach about ");
  ASSERT_NE(at, std::string::npos) << refusal;
  const std::string best = refusal.substr(at + 12, refusal.find(" %", at) - at - 12);

  const Ended ended =
      todbench({"plan", "./plan.toml", "--tolerance-percent", best, "--json"}, {.folder = folder.path()});

  EXPECT_TRUE(ended.code == 0 || ended.code == 3) << ended.err;
  EXPECT_FALSE(one_object(ended)["predicted_s"].is_null());
}

TEST(PlanWithoutThreshold, IsInconclusiveBeforeItStarts) {
  const TemporaryFolder folder;
  folder.write("plan.toml", small_plan(1).replace(small_plan(1).find("16.9"), 4, "0.001"));

  const Ended json = todbench({"plan", "./plan.toml", "--json"}, {.folder = folder.path()});
  const Ended words = todbench({"plan", "./plan.toml"}, {.folder = folder.path()});

  EXPECT_EQ(json.code, 3) << json.err;
  EXPECT_TRUE(one_object(json)["predicted_uncertainty_percent"].is_null());
  EXPECT_EQ(words.code, 3) << words.err;
  EXPECT_THAT(words.err, HasSubstr("the plan has no identifiable threshold: at 0.001 K: no size up to 40 pitches "
                                   "reaches 75 % correct answers"));
}

struct ImpossibleSensor {
  const char* name;
  const char* key_and_value;
  const char* sentence;
};

std::ostream& operator<<(std::ostream& stream, const ImpossibleSensor& sensor) {
  return stream << sensor.name;
}

class SensorThatCannotBe : public ::testing::TestWithParam<ImpossibleSensor> {};

/// Every command that takes a sensor says the same and begins nothing.
TEST_P(SensorThatCannotBe, IsRefusedInASentence) {
  const TemporaryFolder folder;
  std::string text = content_of(source_file("sim_devices/sensors/sc2000.toml"));
  const std::string line = GetParam().key_and_value;
  const std::string key = line.substr(0, line.find(' '));
  const std::size_t from = text.find("\n" + key + " ") + 1;
  ASSERT_NE(from, 0u) << key;
  text.replace(from, text.find('\n', from) - from, line);
  folder.write("impossible.toml", text);
  folder.write("plan.toml", small_plan(1, "sensor = \"impossible.toml\"\n"));

  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"plan", "./plan.toml"},
        {"plan", "./plan.toml", "--json"},
        {"cost", "./plan.toml"},
        {"cost", "./plan.toml", "--json"},
        {"simulate", "./plan.toml", "--out", "s"},
        {"simulate", "--sensor", "./impossible.toml", "--out", "s", "--json"},
        {"render", "--sensor", "./impossible.toml", "--size-pitch", "2"},
        {"mtf", "--sensor", "./impossible.toml", "--frequency-per-pitch", "0.5", "--json"}}) {
    const Ended ended = todbench(command, {.folder = folder.path()});

    expect_refused(ended, 2, GetParam().sentence);
    EXPECT_THAT(ended.err, HasSubstr("impossible.toml")) << command.front();
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, SensorThatCannotBe,
    ::testing::Values(ImpossibleSensor{"negative_aperture", "f_number = -1", "f_number"},
                      ImpossibleSensor{"no_aperture", "f_number = 0", "f_number"},
                      ImpossibleSensor{"detector_larger_than_pitch", "detector_um = 60",
                                       "detector_um is larger than pitch_um: detectors cannot overlap"},
                      ImpossibleSensor{"zero_focal_length", "focal_length_mm = 0", "focal_length_mm"},
                      ImpossibleSensor{"negative_netd", "netd_k = -0.07", "netd_k"}),
    [](const auto& sensor) { return sensor.param.name; });

/// Super-resolution displays two samples per pitch and averages a quarter of its exposures in each.
TEST(RenderOfSuperResolution, HasTheSamplesThatAreDisplayed) {
  const TemporaryFolder folder;
  const auto file = source_file("sim_devices/sensors/sc2000.toml");
  folder.write("sr.toml", content_of(file) + "\nsuper_resolution_frames = 16\n");
  const auto plain = [&](const std::string& noise) {
    return one_object(todbench({"render", "--sensor", "./sr.toml", "--size-pitch", "3", "--window", "32", "--noise",
                                noise, "--delta-t-k", noise == "on" ? "0" : "1", "--json"},
                               {.folder = folder.path()}));
  };

  const Json displayed = plain("off");
  const Json noisy = plain("on");
  const Json microscanned = one_object(
      todbench({"render", "--sensor", "sc2000", "--size-pitch", "3", "--window", "32", "--microscan", "2", "--json"},
               {.folder = folder.path()}));

  EXPECT_DOUBLE_EQ(displayed["pitch_mrad"].get<double>(), 47.5 / 36.3 / 2);
  // The grid and the optics of a sensor with 2x2 microscan.
  EXPECT_EQ(displayed["values"], microscanned["values"]);
  double squares = 0;
  for (const auto& row : noisy["values"]) {
    for (const auto& value : row) squares += value.get<double>() * value.get<double>();
  }
  // 0.07 K over the square root of 16 / 4 exposures, and steps of 0.01 K; 1024 samples tell the variance to
  // sqrt(2 / 1024) = 4.4 %, the sd to 2.2 %; five of them.
  const double sd = std::sqrt(0.035 * 0.035 + 1e-4 / 12);
  EXPECT_NEAR(std::sqrt(squares / 1024), sd, 0.11 * sd);
}

}  // namespace
}  // namespace todbench::testing
