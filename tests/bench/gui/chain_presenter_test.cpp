// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/chain_presenter.h"

#include <gmock/gmock.h>

#include "bench/plan/atmospheres.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/scene_descriptions.h"
#include "bench/studies/scene_pictures.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/bench/gui/gui_test_support.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

const StagePicture& picture(const std::vector<StagePicture>& pictures, Stage stage) {
  return pictures.at(static_cast<std::size_t>(stage));
}

double largest_difference(const cv::Mat1d& a, const cv::Mat1d& b) {
  EXPECT_EQ(a.size(), b.size());
  return a.size() == b.size() ? cv::norm(a, b, cv::NORM_INF) : 1e300;
}

TEST(ChainPresenter, ShowsThePicturesOfTheSensorModelItself) {
  ChainSettings options;
  options.size_pitch = 2.5;
  options.delta_t_k = 0.7;
  options.index = 3;
  auto sensor = load_sensor("sc2000");
  ASSERT_TRUE(sensor);
  // The same square by other means: 2 (ceil(2.5 + 3)) = 12 detectors, the triangle at (0.3, -0.2) from its middle.
  sensor->width = sensor->height = 12;
  PlateScene scene;
  scene.delta_t_k = 0.7;
  scene.background_k = sensor->scene_temperature_k;
  scene.distance_m = 1;
  const double size_mm = 2.5 * sensor->ifov_mrad();
  scene.plate.width_mm = scene.plate.height_mm = 10 * size_mm;
  scene.plate.triangles = {{.name = "t", .position_mm = {0, 0}, .size_mm = size_mm, .apex = Apex::up}};
  const SensorModel model(*sensor, full_plan(*sensor, {}, {}), Accuracy::normal(), options.seed);

  const auto pictures = chain_pictures(options);

  ASSERT_TRUE(pictures) << pictures.error().message;
  cv::Mat1d samples, quantised;
  model.unit_signal(scene)->convertTo(samples, CV_64F, 0.7);
  model.picture(scene, 3).convertTo(quantised, CV_64F);
  EXPECT_EQ(largest_difference(picture(*pictures, Stage::samples).kelvin, samples), 0);
  EXPECT_EQ(largest_difference(picture(*pictures, Stage::quantised).kelvin, quantised), 0);
}

TEST(ChainPresenter, ShowsTheDetectorsPictureOfTheImageChain) {
  ChainSettings options;
  options.size_pitch = 2.5;
  options.delta_t_k = 2;
  auto sensor = load_sensor("sc2000");
  ASSERT_TRUE(sensor);
  const ImageChain chain(*sensor, full_plan(*sensor, {}, {}), Accuracy::normal());
  // 12 pitches at 16 points; the first point is half a step inside the corner, the triangle at (0.3, -0.2).
  const cv::Point2d first(-6 + 1.0 / 32 - 0.3, -6 + 1.0 / 32 + 0.2);

  const auto pictures = chain_pictures(options);

  ASSERT_TRUE(pictures) << pictures.error().message;
  const cv::Mat1d expected = 2.0 * chain.image(triangle(2.5, Apex::up)).sample(first, 1.0 / 16, {192, 192});
  EXPECT_LT(largest_difference(picture(*pictures, Stage::detector).kelvin, expected), 1e-12);
}

TEST(ChainPresenter, LeavesOutWhatIsSwitchedOff) {
  ChainSettings options;
  options.skip = {Effect::temporal_noise, Effect::quantisation};

  const auto pictures = chain_pictures(options);

  ASSERT_TRUE(pictures) << pictures.error().message;
  const cv::Mat1d& samples = picture(*pictures, Stage::samples).kelvin;
  // Single precision of the model's pictures at 1 K.
  EXPECT_LT(largest_difference(picture(*pictures, Stage::noise).kelvin, samples), 1e-6);
  EXPECT_LT(largest_difference(picture(*pictures, Stage::quantised).kelvin, samples), 1e-6);
}

TEST(ChainPresenter, KeepsTheSignalOfASceneThroughOpticsAndDetector) {
  ChainSettings options;
  options.size_pitch = 3;

  const auto pictures = chain_pictures(options);

  ASSERT_TRUE(pictures) << pictures.error().message;
  // Area 9 pitches squared times 1 K, in points of 1/256; diffraction leaves some of it outside the square of 12
  // pitches: its tails carry about 2 / (pi^2 r) of the energy beyond r = 6 cut-off lengths, under 2 %.
  const double area = cv::sum(picture(*pictures, Stage::scene).kelvin)[0] / 256;
  EXPECT_NEAR(area, 9, 9 * 0.002);
  for (const Stage stage : {Stage::optics, Stage::detector})
    EXPECT_NEAR(cv::sum(picture(*pictures, stage).kelvin)[0] / 256, 9, 9 * 0.02);
}

TEST(ChainPresenter, ComputesInTheBackgroundAndSaysWhenItIsDone) {
  const testing::TemporaryFolder folder;
  Workbench bench(folder.path());
  ChainPresenter presenter(bench);

  presenter.set_options({});

  EXPECT_TRUE(presenter.busy());
  EXPECT_TRUE(testing::wait_until([&] { return !presenter.busy(); }));
  EXPECT_EQ(presenter.pictures().size(), all_stages.size());
  bench.shut_down();
}

TEST(ChainPresenter, ShowsAScenesPicturesAsTheCommandMakesThem) {
  ChainSettings options;
  options.scene = "craft-at-sea";
  options.atmosphere = "us-standard";
  options.range_m = 700;
  ScenePicturesTask task;
  const auto scene = load_scene("craft-at-sea", {});
  const auto sensor = load_sensor("sc2000");
  const auto air = load_atmosphere("us-standard", {.band = {7.5, 13}});
  ASSERT_TRUE(scene && sensor && air);
  task.scene = *scene;
  task.sensor = *sensor;
  task.air = *air;
  task.view.range_m = 700;
  task.accuracy = Accuracy::draft();
  task.observer = load_observer("hvs-1").value();

  const auto pictures = chain_pictures(options);
  const auto expected = scene_pictures(task);

  ASSERT_TRUE(pictures) << pictures.error().message;
  ASSERT_TRUE(expected) << expected.error().message;
  ASSERT_EQ(pictures->size(), all_stages.size());
  for (std::size_t i = 0; i < all_stages.size(); ++i) EXPECT_EQ((*pictures)[i].stage, all_stages[i]);
  cv::Mat1d noise, display;
  expected->stages[4].kelvin.convertTo(noise, CV_64F);
  expected->stages[5].kelvin.convertTo(display, CV_64F);
  EXPECT_EQ(largest_difference(picture(*pictures, Stage::noise).kelvin, noise), 0);
  EXPECT_EQ(largest_difference(picture(*pictures, Stage::display).kelvin, display), 0);
  EXPECT_EQ(picture(*pictures, Stage::quantised).kelvin.size(), noise.size());
  EXPECT_EQ(pictures->front().grey_k->first, expected->grey_low_k);
  options.range_m = 1e7;
  EXPECT_FALSE(chain_pictures(options)) << "beyond the air's table";
}

}  // namespace
}  // namespace todbench
