// SPDX-License-Identifier: GPL-3.0-or-later
// A hot bar in the field of a camera: without effect on a linear one, with effect behind a gain control.
#include "bench/scene_dependence/scene_dependence.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "bench/moving_target/dynamic_session.h"
#include "bench/plan/plan.h"
#include "bench/scene_dependence/scene_dependence_session.h"
#include "bench/text/text.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/support/temporary_folder.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

LoadedPlan bar_plan() {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {1.93, 16.9};
  plan.simulation.accuracy = "draft";
  plan.measurement.registration_frames = 16;
  plan.measurement.contrast_frames = 4;
  plan.limits = {};
  return LoadedPlan::load(plan).value();
}

const SceneDependenceOptions quick{.cycles = 4, .frames = 4};

EnhancementPackage package_of_stage(StagePlan stage) {
  EnhancementPackage package;
  package.name = "package";
  package.stages = {std::move(stage)};
  return package;
}

TEST(SceneDependence, OfALinearCameraIsNone) {
  const auto found = plan_scene_dependence(bar_plan(), nullptr, 40, quick, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->verdict, SceneDependenceVerdict::independent);
  EXPECT_EQ(found->set_delta_t_k, 16.9) << "the largest contrast";
  EXPECT_EQ(found->sizes.size(), 5u);
  for (const SizeDependence& size : found->sizes) {
    EXPECT_NEAR(size.ratio, 1, 0.01) << size.size_mm;
    EXPECT_EQ(size.triangles, 4);
    EXPECT_TRUE(*size.ci95.low <= size.ratio && size.ratio <= *size.ci95.high);
  }
}

TEST(SceneDependence, IsThatOfTheCameraWhateverObserverThePlanNames) {
  Plan plan = bar_plan().plan();
  plan.observer = "hvs-2";
  plan.display.pixel_pitch_mm = 0.27, plan.display.viewing_distance_m = 0.6;
  plan.display.luminance_white_cd_m2 = 200;
  const auto seeing = LoadedPlan::load(plan);
  ASSERT_TRUE(seeing) << seeing.error().message;
  const SceneDependenceOptions short_study{.cycles = 3, .frames = 4};

  const auto found = plan_scene_dependence(*seeing, nullptr, 40, short_study, {}, {});
  const auto blind = plan_scene_dependence(bar_plan(), nullptr, 40, short_study, {}, {});

  ASSERT_TRUE(found && blind) << found.error().message;
  ASSERT_EQ(found->sizes.size(), blind->sizes.size());
  for (std::size_t i = 0; i < found->sizes.size(); ++i) EXPECT_EQ(found->sizes[i].ratio, blind->sizes[i].ratio);
}

TEST(SceneDependence, OfALinearFilterIsNone) {
  StagePlan stage;
  stage.kind = StagePlan::Kind::sharpen;
  const EnhancementPackage package = package_of_stage(stage);

  const auto found = plan_scene_dependence(bar_plan(), &package, 40, quick, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->verdict, SceneDependenceVerdict::independent);
}

constexpr int plateau_counts = 10;

/// Contrast of the large triangles behind the gain control, by medians, in frames of the plan's sensor; an independent
/// way to what the command finds by regression.
double contrast_behind_gain(const LoadedPlan& loaded, double bar_k) {
  const SensorSpec& sensor = loaded.sensor();
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 99);
  PlateScene scene;
  scene.plate = loaded.plates().front();
  scene.delta_t_k = 16.9;
  const double scale = 1 / (scene.distance_m * sensor.ifov_mrad());
  const cv::Size size(sensor.width, sensor.height);
  const cv::Point2d origin = scene_pixel(scene, {0, 0}, sensor.ifov_mrad(), size);
  Registration registration;
  registration.scale_px_per_mm = scale;
  registration.plate_to_pixel = {scale, 0, origin.x, 0, scale, origin.y, 0, 0, 1};
  const auto stage = gain_control(plateau_counts);
  cv::Mat1d sum = cv::Mat1d::zeros(size);
  for (std::uint64_t k = 0; k < 8; ++k) {
    cv::Mat1w counts = model.expose(scene, k);
    counts(place_of_bar(size, scene.plate, scale).value()) += bar_k / sensor.kelvin_per_count;
    cv::Mat1f picture;
    counts.convertTo(picture, CV_32F);
    cv::Mat1d answer;
    stage->process(picture).value().convertTo(answer, CV_64F);
    sum += answer;
  }
  return effective_contrast(sum, scene.plate, registration, 4).value().value;
}

TEST(SceneDependence, OfAGainControlIsWhatMediansOfItsFramesShow) {
  StagePlan stage;
  stage.kind = StagePlan::Kind::agc;
  stage.plateau_counts = plateau_counts;
  const EnhancementPackage package = package_of_stage(stage);
  const LoadedPlan plan = bar_plan();

  const auto found = plan_scene_dependence(plan, &package, 40, quick, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->verdict, SceneDependenceVerdict::depends);
  const double by_medians = contrast_behind_gain(plan, 40) / contrast_behind_gain(plan, 0);
  EXPECT_LT(by_medians, 0.9);
  for (const SizeDependence& size : found->sizes)
    EXPECT_NEAR(size.ratio, by_medians, 0.03 * by_medians) << "a gain that is the same everywhere";
}

TEST(SceneDependence, OfACameraHasItsBarMovedByTheOperator) {
  Plan plan = bar_plan().plan();
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = 1.3085399449;
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_TRUE(loaded) << loaded.error().message;
  std::vector<bool> asked;
  ExperimentHost host;
  host.ask_operator = [&](const OperatorRequest& request, const std::stop_token&) -> Result<OperatorAnswer> {
    for (const OperatorStep& step : request.steps) asked.push_back(std::get<MoveHotBar>(step).in);
    return asked.size() <= 7 ? OperatorAnswer::done : OperatorAnswer::stop;
  };

  const auto found = plan_scene_dependence(*loaded, nullptr, 40, {.cycles = 3, .frames = 4}, host, {});
  const auto stopped = plan_scene_dependence(*loaded, nullptr, 40, {.cycles = 4, .frames = 4}, host, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->verdict, SceneDependenceVerdict::independent) << "nobody brought a bar";
  ASSERT_GE(asked.size(), 7u);
  EXPECT_THAT(std::vector<bool>(asked.begin(), asked.begin() + 7),
              ::testing::ElementsAre(false, true, false, true, false, true, false))
      << "asked only where it has to move";
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::interrupted);
  const StagePlan stage;
  const EnhancementPackage package = package_of_stage(stage);
  EXPECT_FALSE(plan_scene_dependence(*loaded, &package, 40, quick, host, {})) << "a package behind a camera";
}

TEST(SceneDependenceSession, ThatIsStoppedIsMarkedSo) {
  const testing::TemporaryFolder folder;
  std::stop_source stop;
  stop.request_stop();

  const auto session = measure_scene_dependence_session(bar_plan(), {.options = quick},
                                                        {.folder = folder.path() / "stopped"}, {}, stop.get_token());

  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().code, ErrorCode::interrupted);
  const auto kept = read_session(folder.path() / "stopped");
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->provenance.state, SessionState::interrupted);
  EXPECT_EQ(verdict_of(*kept).decision, VerdictKind::inconclusive);
}

TEST(SceneDependenceSession, IsJudgedByTheSizeThatIsFarthestOff) {
  SceneDependence found;
  found.set_delta_t_k = 16.9, found.tolerance_percent = 2;
  found.sizes = {{.size_mm = 25, .ratio = 1.001, .ci95 = {0.999, 1.003}},
                 {.size_mm = 10, .ratio = 0.95, .ci95 = {0.94, 0.96}}};
  found.verdict = SceneDependenceVerdict::depends;
  LimitsPlan limits;
  const Verdict fails = verdict_on(found, limits);
  found.sizes.pop_back();
  found.verdict = SceneDependenceVerdict::independent;
  limits.acuity = {{.delta_t_k = 16.9, .least_acuity_per_mrad = 0.1}};
  const Verdict passes = verdict_on(found, limits);

  EXPECT_EQ(fails.decision, VerdictKind::fail);
  ASSERT_EQ(fails.demands.size(), 1u);
  EXPECT_NEAR(*fails.demands[0].result, 100 * (1 / 0.95 - 1), 1e-9);
  EXPECT_NEAR(*fails.demands[0].interval.low, 100 * (1 / 0.96 - 1), 1e-9);
  EXPECT_NEAR(*fails.demands[0].interval.high, 100 * (1 / 0.94 - 1), 1e-9);
  EXPECT_EQ(passes.decision, VerdictKind::pass);
  EXPECT_EQ(*passes.demands[0].interval.low, 0) << "the interval holds 1";
  EXPECT_NE(passes.reason, verdict_on(found, {}).reason) << "limits of the plan were not judged";
}

/// Rows that are on the disk, without the header.
std::size_t rows_of(const std::filesystem::path& csv) {
  const auto text = read_text_file(csv).value_or("");
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, std::count(text.begin(), text.end(), '\n'))) - 1;
}

TEST(DynamicSession, ThatIsStoppedKeepsItsTrialsAndSaysSo) {
  const testing::TemporaryFolder folder;
  Plan plan = bar_plan().plan();
  plan.target.delta_t_k = {16.9};
  plan.motion = {.speeds_mrad_s = {30}, .passes = 4, .frames = 2, .lead_frames = 1};
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_TRUE(loaded) << loaded.error().message;
  std::stop_source stop;
  std::vector<std::size_t> moving_rows, rows;
  const auto on_pass = [&](const MovingPassRecord& pass) {
    moving_rows.push_back(rows_of(folder.path() / "stopped" / "moving-trials.csv"));
    rows.push_back(rows_of(folder.path() / "stopped" / "trials.csv"));
    if (pass.pass == 3) stop.request_stop();
  };

  const auto session =
      measure_dynamic_session(*loaded, {.folder = folder.path() / "stopped"}, {}, on_pass, stop.get_token());

  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().code, ErrorCode::interrupted);
  const auto kept = read_session(folder.path() / "stopped");
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->provenance.state, SessionState::interrupted);
  EXPECT_EQ(kept->trials.size(), 2u * 20) << "two passes at rest before the fourth pass of all";
  // Twenty triangles and four observers a pass, on the disk when the pass is over; at rest every second pass.
  EXPECT_THAT(moving_rows, ::testing::ElementsAre(80, 160, 240, 320));
  EXPECT_THAT(rows, ::testing::ElementsAre(20, 20, 40, 40));
}

TEST(DynamicSession, RefusesInOneSentenceWhatItDoesNotMeasure) {
  Plan plan = bar_plan().plan();
  EXPECT_TRUE(check_dynamic_plan(plan, {}));
  plan.measures.noise = true;
  plan.limits.equivalence_margin_percent = 10;
  plan.camera.nuc_interval_s = 60;
  const auto refused = check_dynamic_plan(plan, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  for (const char* name : {"[measures]", "equivalence_margin_percent", "nuc_interval_s"})
    EXPECT_THAT(refused.error().message, ::testing::HasSubstr(name));
}

TEST(SceneDependence, IsRefusedWithoutRoomForABarAndWithoutCycles) {
  TargetPlate plate;
  plate.width_mm = 200;
  plate.height_mm = 280;
  EXPECT_FALSE(place_of_bar({120, 120}, plate, 1 / 2.617).has_value());
  const auto place = place_of_bar({320, 240}, plate, 1 / 2.617);
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(*place & cv::Rect(0, 0, (320 - 107) / 2, 240), *place) << "beside the plate";

  const auto once = plan_scene_dependence(bar_plan(), nullptr, 40, {.cycles = 1}, {}, {});
  ASSERT_FALSE(once);
  EXPECT_EQ(once.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
