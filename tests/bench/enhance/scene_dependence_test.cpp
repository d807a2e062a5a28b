// A hot bar in the field of a camera: without effect on a linear one, with effect behind a gain control.
#include "bench/enhance/scene_dependence.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bench/plan/plan.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

LoadedPlan bar_plan() {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
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
