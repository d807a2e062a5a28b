// SPDX-License-Identifier: GPL-3.0-or-later
// Measurements with the emulated laboratory in a process of its own: what ends well, and every way a device fails.
#include <signal.h>

#include <cmath>

#include "bench/session/session_folder.h"
#include "bench/session/trials_csv.h"
#include "tests/system/system_test_support.h"

namespace todbench::testing {
namespace {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

constexpr int endless = 10000;
constexpr std::size_t trials_per_frame = 20;

/// `todbench emulate` on ports that the system chose.
class EmulatedLaboratory {
 public:
  explicit EmulatedLaboratory(const std::vector<std::string>& more = {}) : child_(command(more)) {
    if (!child_.wait_until([this] { return child_.out().find('\n') != std::string::npos; })) {
      ADD_FAILURE() << "the laboratory does not start: " << child_.wait().err;
      return;
    }
    addresses_ = Json::parse(child_.out(), nullptr, false);
  }
  [[nodiscard]] const Json& addresses() const { return addresses_; }
  [[nodiscard]] ChildProcess& process() { return child_; }

  /// A plan for this laboratory: one plate, one mounting, 16.9 K.
  [[nodiscard]] std::string plan(int phases, const std::string& target = "", const std::string& camera = "") const {
    return "name = \"laboratory\"\n[camera]\nid = \"gige:127.0.0.1\"\nifov_mrad = 1.3085399449\nreconnect_s = 1\n" +
           camera +
           "[simulation]\naccuracy = \"draft\"\nphases = 4\n[measurement]\nregistration_frames = 4\n"
           "contrast_frames = 4\n[target]\nkind = \"scpi\"\nblack_body = \"" +
           addresses_.at("black_body").get<std::string>() + "\"\nstage = \"" +
           addresses_.at("stage").get<std::string>() +
           "\"\ndistance_m = 2\nplates = [\"tcat-a\"]\nmountings = [\"identity\"]\ndelta_t_k = [16.9]\nphases = " +
           std::to_string(phases) + "\n" + target;
  }

 private:
  static std::vector<std::string> command(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"emulate", "--json", "--black-body-port", "0", "--stage-port", "0"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return todbench_command(arguments);
  }
  ChildProcess child_;
  Json addresses_;
};

class Laboratories : public ::testing::Test {
 protected:
  void write_plan(const std::string& plan) { folder_.write("plan.toml", plan); }
  /// Returns the absolute path.
  std::string write(const std::string& name, const std::string& text) {
    folder_.write(name, text);
    return (folder_.path() / name).string();
  }
  Ended measure(const std::string& out = "m") {
    return todbench({"measure", "./plan.toml", "--out", out, "--json"}, {.folder = folder_.path()});
  }
  std::unique_ptr<ChildProcess> start_measuring() {
    return std::make_unique<ChildProcess>(todbench_command({"measure", "./plan.toml", "--out", "m", "--json"}),
                                          ChildOptions{.folder = folder_.path()});
  }
  std::filesystem::path session() const { return folder_.path() / "m"; }
  /// Waits until the run has trials of two frames on disk.
  bool has_trials(ChildProcess& child) const {
    return child.wait_until([this] { return rows_in(session() / "trials.csv") >= 2 * trials_per_frame; });
  }
  /// A run that ended in the middle: its code, its sentence, and a session that keeps what was measured.
  void expect_partial_session(const Ended& ended, int code, const std::string& sentence) const {
    EXPECT_EQ(ended.code, code) << ended.err;
    EXPECT_THAT(lines_of(ended.err).back(),
                AllOf(::testing::StartsWith("todbench: ended early: "), HasSubstr(sentence), HasSubstr("are in m")));
    EXPECT_EQ(one_object(ended)["points"].size(), 1u);
    expect_whole_session(session(), "interrupted");
    const auto trials = read_trials(session() / "trials.csv");
    ASSERT_TRUE(trials) << trials.error().message;
    EXPECT_GE(trials->size(), 2 * trials_per_frame);
    EXPECT_EQ(trials->size() % trials_per_frame, 0u);
    EXPECT_THAT(content_of(session() / "report.html"), HasSubstr("INTERRUPTED"));
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Laboratories, AMeasurementOverTheNetworkIsAWholeSession) {
  EmulatedLaboratory laboratory({"--serial", "T0042"});
  write_plan(laboratory.plan(8));

  const Ended ended = measure();

  ASSERT_TRUE(completed(ended));
  EXPECT_EQ(one_object(ended)["points"][0]["trials"], 8 * trials_per_frame);
  expect_whole_session(session(), "complete");
  const Json provenance = Json::parse(content_of(session() / "provenance.json"));
  EXPECT_EQ(provenance["camera"]["serial"], "T0042");
  EXPECT_EQ(provenance["camera"]["transport"], "GigE Vision");
}

TEST_F(Laboratories, PixelsThatAreNotSquareHaveTheShapeOfTheSensor) {
  EmulatedLaboratory laboratory({"--sensor", write("tall.toml", tall_sensor(54))});
  const std::string square = laboratory.plan(8, "[measures]\ngeometry = true\n");
  std::string tall = square;
  tall.replace(tall.find("[simulation]\n"), 13, "[simulation]\nsensor = \"./tall.toml\"\n");
  tall.replace(tall.find("phases = 4"), 10, "phases = 8");
  write_plan(tall);

  const Ended measured = measure();
  const Ended simulated =
      todbench({"simulate", "./plan.toml", "--out", "s", "--json"}, {.folder = session().parent_path()});

  ASSERT_TRUE(completed(measured));
  ASSERT_TRUE(completed(simulated));
  const auto ln_s75 = [](const Ended& ended) {
    return std::log(one_object(ended)["points"][0]["s75_mrad"].get<double>());
  };
  // Eight presentations of one mounting: runs of either kind scatter by 0.8 % (seeds 1 to 5).
  EXPECT_NEAR(ln_s75(measured), ln_s75(simulated), 0.05);
  const Json lines = Json::parse(content_of(session() / "measures.json"))["main"]["quantities"];
  const auto measure_of = [&](const std::string& name) {
    for (const Json& line : lines)
      if (line["measure"] == name) return line["value"].get<double>();
    return 0.0;
  };
  EXPECT_NEAR(measure_of("aspect_ratio"), 47.5 / 60, 0.002);
  EXPECT_NEAR(measure_of("ifov_y"), 60 / 36.3, 0.005);

  write_plan(square);
  const Ended believed = measure("believed");
  EXPECT_EQ(believed.code, 6) << believed.err;
  EXPECT_THAT(believed.err,
              AllOf(HasSubstr("is stretched in the picture"), HasSubstr("whether the pixels are square")));
}

/// S75 in mrad of hvs-1 with the SC2000 at 10 and 1.93 K, without trials; standard error 0.05 %.
constexpr double s75_at_10_k = 2.09153, s75_at_1_93_k = 2.13759;

void expect_ln_s75(const Json& point, double s75_mrad) {
  const Json& interval = point["s75_ci95_mrad"];
  EXPECT_GT(point["s75_mrad"].get<double>(), 0);
  // One run: four standard errors, half of the interval each two of them.
  const double half = 0.5 * std::log(interval[1].get<double>() / interval[0].get<double>());
  EXPECT_NEAR(std::log(point["s75_mrad"].get<double>() / s75_mrad), 0, 2 * half) << point.dump();
  EXPECT_LT(half, 0.1);
}

TEST_F(Laboratories, ContrastsWithinASettlingBandGiveTheThresholdAtTheSetContrast) {
  EmulatedLaboratory laboratory({"--black-body-time-constant-s", "2"});
  std::string plan = laboratory.plan(6, "contrast_settling_band_percent = 10\n");
  plan.replace(plan.find("mountings = [\"identity\"]"), 24, "mountings = [\"identity\", \"rotated_180\"]");
  plan.replace(plan.find("[16.9]"), 6, "[16.9, 1.93]");
  write_plan(plan);

  const Ended ended = measure();

  ASSERT_TRUE(completed(ended));
  const Json run = one_object(ended);
  expect_ln_s75(run["points"][1], s75_at_1_93_k);
  // The read-back of a presentation that began within the band has not settled.
  bool on_the_way = false;
  const auto targets = read_session(session());
  ASSERT_TRUE(targets) << targets.error().message;
  for (const Presentation& shown : targets->presentations)
    on_the_way = on_the_way || std::abs(shown.said.state.delta_t_k - shown.set.delta_t_k) > 0.01;
  EXPECT_TRUE(on_the_way);
}

TEST_F(Laboratories, ARampStatesTheCurveAndTheLagOfThePlate) {
  EmulatedLaboratory laboratory({"--black-body-time-constant-s", "0.5", "--plates", "tcat-a,tcat-b"});
  std::string plan = laboratory.plan(
      6,
      "max_contrast_lag_s = 0.05\nmountings_per_plate = [3, 2]\n[schedule]\nkind = \"ramp\"\nramp_k_per_s = 6\n"
      "from_delta_t_k = 16.9\nto_delta_t_k = 4\n");
  plan.replace(plan.find("plates = [\"tcat-a\"]\nmountings = [\"identity\"]"), 44, "plates = [\"tcat-a\", \"tcat-b\"]");
  plan.replace(plan.find("[16.9]"), 6, "[10]");
  write_plan(plan);

  const Ended ended = measure();

  ASSERT_TRUE(completed(ended));
  const Json run = one_object(ended);
  expect_ln_s75(run["points"][0], s75_at_10_k);
  EXPECT_THAT(ended.err, HasSubstr("change later than the large ones by"));
  EXPECT_THAT(ended.err, HasSubstr("up to 2.03 K/s it stays below 0.6 %")) << "0.006 / 0.05 s of 16.9 K";
  EXPECT_THAT(run["points"][0]["adequacy"]["findings"].dump(), ::testing::Not(HasSubstr("contrast_lag")));
  EXPECT_GE(run["curve"].size(), 40u);
}

/// How far a value lies from the closed form, in half-widths of its 95 % interval.
double half_widths(double value, const Json& interval, double model) {
  return std::abs(value - model) / (0.5 * (interval[1].get<double>() - interval[0].get<double>()));
}

TEST_F(Laboratories, TheStageShowsEdgeAndBarsAndTheyGiveTheTransferOfTheCamera) {
  EmulatedLaboratory laboratory({"--plates", "tcat-a,edge,bars"});
  write_plan(laboratory.plan(1) +
             "[measures]\ngeometry = true\nmtf = true\nctf = true\nmtf_frames = 32\nctf_frames = 32\n"
             "[[uncertainty.component]]\nname = \"distance\"\nvalue = 0.001\nunit = \"m\"\n");

  const Ended ended = measure();

  ASSERT_TRUE(completed(ended));
  const Json measures = Json::parse(content_of(session() / "measures.json"));
  const Json &camera = measures["main"], &twin = measures["twin"];
  EXPECT_TRUE(camera["reasons"].empty()) << camera["reasons"];
  int axes = 0;
  for (const Json& quantity : camera["quantities"]) {
    if (quantity["measure"] != "ifov_x" && quantity["measure"] != "ifov_y") continue;
    ++axes;
    const double ifov_mrad = 1.3085399449;
    EXPECT_LT(quantity["expanded_ci95"][0], ifov_mrad);
    EXPECT_GT(quantity["expanded_ci95"][1], ifov_mrad);
    EXPECT_LT(half_widths(quantity["value"], quantity["ci95"], ifov_mrad), 2) << quantity;
  }
  EXPECT_EQ(axes, 2);
  ASSERT_EQ(camera["mtf"]["edges"].size(), 2u) << camera;
  ASSERT_EQ(camera["ctf"]["groups"].size(), 10u) << camera;
  // The emulated camera is the sensor of the twin. Two half-widths are four standard uncertainties.
  for (std::size_t i = 0; i < 2; ++i) {
    const Json &edge = camera["mtf"]["edges"][i], &model = twin["mtf"]["edges"][i]["model"];
    for (const std::size_t k : {10u, 25u, 50u})
      EXPECT_LT(half_widths(edge["mtf"][k], edge["mtf_ci95"][k], model[k]), 2) << edge["axis"] << k;
  }
  for (std::size_t i = 0; i < 10; ++i) {
    const Json &group = camera["ctf"]["groups"][i], &model = twin["ctf"]["groups"][i]["model"];
    for (const char* phase : {"best", "worst"})
      EXPECT_LT(half_widths(group[phase]["value"], group[phase]["ci95"], model[phase]), 2) << group["group"] << phase;
  }
}

#ifdef TODBENCH_MODULE_EXAMPLE
TEST_F(Laboratories, AProgramBehindALiveCameraCostsNoFrame) {
  EmulatedLaboratory laboratory;
  std::string plan = laboratory.plan(4) + "[[module]]\ncommand = \"" TODBENCH_MODULE_EXAMPLE " double\"\n";
  // Packets that a busy host loses are no frames that the module costs.
  const std::string section = "[measurement]\n";
  plan.insert(plan.find(section) + section.size(), "max_rejected_share = 0.5\n");
  write_plan(plan);

  const Ended ended = measure();

  ASSERT_TRUE(completed(ended));
  EXPECT_EQ(one_object(ended)["points"][0]["trials"], 4 * trials_per_frame);
  // The camera tells nothing of its corrections; twice its picture is none.
  EXPECT_THAT(content_of(session() / "log.txt"), ::testing::Not(HasSubstr("nonuniformity_correction")));
}
#endif

TEST_F(Laboratories, EmulateAndDevicesTellTheAddressesAsJson) {
  EmulatedLaboratory laboratory;

  const Ended devices = todbench({"devices", "--json"});

  EXPECT_THAT(keys_of(laboratory.addresses()), UnorderedElementsAre("camera", "black_body", "stage"));
  ASSERT_EQ(devices.code, 0) << devices.err;
  const Json json = one_object(devices);
  EXPECT_THAT(keys_of(json), UnorderedElementsAre("cameras", "warnings"));
  bool seen = false;
  for (const auto& camera : json["cameras"]) {
    EXPECT_THAT(keys_of(camera), UnorderedElementsAre("id", "vendor", "model", "serial", "transport", "address"));
    seen = seen || camera["id"] == laboratory.addresses()["camera"]["id"];
  }
  EXPECT_TRUE(seen) << devices.out;
}

TEST_F(Laboratories, TheCameraIsFoundByTheIdentityThatIsListed) {
  EmulatedLaboratory laboratory;
  std::string plan = laboratory.plan(1);
  plan.replace(plan.find("gige:127.0.0.1"), 14, laboratory.addresses()["camera"]["id"].get<std::string>());
  write_plan(plan);

  EXPECT_TRUE(completed(measure()));
}

TEST_F(Laboratories, EmulateEndsOnCtrlC) {
  EmulatedLaboratory laboratory;

  laboratory.process().signal(SIGINT);

  EXPECT_EQ(laboratory.process().wait().code, 130);
}

TEST_F(Laboratories, ASecondLaboratoryOnTheSameAddressIsOneSentence) {
  EmulatedLaboratory laboratory;

  const Ended ended = todbench({"emulate", "--json", "--black-body-port", "0", "--stage-port", "0"});

  expect_refused(ended, 4, "3956");
}

TEST_F(Laboratories, APlateThatNobodyKnowsIsRefusedByName) {
  expect_refused(todbench({"emulate", "--plates", "tcat-x"}), 2, "unknown plate 'tcat-x', did you mean 'tcat-a'?");
}

TEST_F(Laboratories, AnAbsentCameraLeavesNoFolder) {
  std::string plan;
  {
    EmulatedLaboratory laboratory;
    plan = laboratory.plan(1);
  }
  write_plan(plan);
  const Ended by_address = measure();
  plan.replace(plan.find("gige:127.0.0.1"), 14, "gige:Nobody-7");
  write_plan(plan);
  const Ended by_identity = measure();

  expect_refused(by_address, 4, "no GigE Vision device answers at 127.0.0.1");
  expect_refused(by_identity, 4, "no such camera; found: ");
  EXPECT_FALSE(std::filesystem::exists(session()));
}

TEST_F(Laboratories, ABusyCameraIsSaidToBeBusy) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(endless));
  const auto first = start_measuring();
  ASSERT_TRUE(has_trials(*first));

  const Ended second = measure("second");

  expect_refused(second, 4, "busy: another program controls");
  EXPECT_TRUE(first->wait_until([&, rows = rows_in(session() / "trials.csv")] {
    return rows_in(session() / "trials.csv") > rows;  // the first goes on
  }));
}

TEST_F(Laboratories, AnAbsentBlackBodyIsNamed) {
  EmulatedLaboratory laboratory;
  std::string plan = laboratory.plan(1);
  // Port 1 is nobody's.
  const std::string black_body = laboratory.addresses()["black_body"];
  plan.replace(plan.find(black_body), black_body.size(), "127.0.0.1:1");
  write_plan(plan);

  expect_refused(measure(), 4, "127.0.0.1:1");
}

TEST_F(Laboratories, AFormatThatTheCameraDoesNotHaveIsRefused) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(1, "", "[camera.settings]\nPixelFormat = \"Mono8\"\n"));

  expect_refused(measure(), 2, "setting PixelFormat = Mono8");
}

TEST_F(Laboratories, ASettingThatTheCameraDoesNotKnowIsRefused) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(1, "", "[camera.settings]\nGaimn = 3\n"));

  expect_refused(measure(), 2, "setting Gaimn = 3");
}

TEST_F(Laboratories, ATargetThatDoesNotSettleIsATimeout) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(1, "settle_timeout_s = 0.001\n"));

  expect_refused(measure(), 5, "presenting the target: ");
}

TEST_F(Laboratories, AScaleThatContradictsTheDistanceIsACalibrationError) {
  EmulatedLaboratory laboratory({"--distance-m", "2.2"});
  write_plan(laboratory.plan(1));

  expect_refused(measure(), 6, "registering plate tcat-a");
}

TEST_F(Laboratories, ACameraThatIsKilledInMidRunLeavesItsTrials) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(endless));
  const auto measuring = start_measuring();
  ASSERT_TRUE(has_trials(*measuring));

  laboratory.process().signal(SIGKILL);

  expect_partial_session(measuring->wait(), 5, "");
}

TEST_F(Laboratories, ACameraThatFallsSilentInMidRunLeavesItsTrials) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(endless));
  const auto measuring = start_measuring();
  ASSERT_TRUE(has_trials(*measuring));

  laboratory.process().signal(SIGSTOP);

  expect_partial_session(measuring->wait(), 5, "");
}

TEST_F(Laboratories, CtrlCLeavesItsTrialsAndTheCameraFree) {
  EmulatedLaboratory laboratory;
  write_plan(laboratory.plan(endless));
  const auto measuring = start_measuring();
  ASSERT_TRUE(has_trials(*measuring));

  measuring->signal(SIGINT);
  const Ended ended = measuring->wait();
  write_plan(laboratory.plan(1));
  const Ended next = measure("next");

  expect_partial_session(ended, 130, "stopped");
  EXPECT_TRUE(completed(next));
}

}  // namespace
}  // namespace todbench::testing
