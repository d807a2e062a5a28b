// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/sensor_model.h"

#include <gmock/gmock.h>

#include <cmath>
#include <thread>

#include "sim_devices/sensor/image_chain.h"
#include "tests/sim_devices/reference.h"

namespace todbench {
namespace {

PlateScene scene_of_one(double size_mm = 6, double delta_t_k = 16.9) {
  PlateScene scene;
  scene.plate.name = "one";
  scene.plate.triangles = {{.name = "only", .position_mm = {10, -20}, .size_mm = size_mm, .apex = Apex::right}};
  scene.delta_t_k = delta_t_k;
  return scene;
}

SensorModel model(const SensorSpec& spec, const std::vector<Effect>& skip = {}, const std::vector<Effect>& force = {},
                  std::uint64_t seed = 1) {
  return {spec, full_plan(spec, skip, force), Accuracy::normal(), seed};
}

bool equal(const cv::Mat1w& a, const cv::Mat1w& b) {
  return cv::countNonZero(a != b) == 0;
}

TEST(SensorModel, ExposeIsAPureFunctionOfSceneAndIndex) {
  const SensorSpec spec = test::sc2000();
  const auto a = model(spec);
  const auto b = model(spec);
  PlateScene other = scene_of_one(4);
  (void)b.expose(other, 3);

  EXPECT_TRUE(equal(a.expose(scene_of_one(), 7), b.expose(scene_of_one(), 7)));
  EXPECT_FALSE(equal(a.expose(scene_of_one(), 7), a.expose(scene_of_one(), 8)));
  EXPECT_FALSE(equal(a.expose(scene_of_one(), 7), model(spec, {}, {}, 2).expose(scene_of_one(), 7)));
}

TEST(SensorModel, GivesTheSameFramesOnTwoThreads) {
  const auto m = model(test::sc2000());
  cv::Mat1w first, second;

  {
    std::jthread one([&] { first = m.expose(scene_of_one(), 5); });
    std::jthread two([&] { second = m.expose(scene_of_one(), 5); });
  }

  EXPECT_TRUE(equal(first, second));
}

TEST(SensorModel, PutsTheExactDegradedTriangleWhereTheSceneSaysSo) {
  const SensorSpec spec = test::sc2000();
  const PlateScene scene = scene_of_one();

  const auto picture = model(spec).unit_signal(scene);

  const cv::Point2d centre = scene_pixel(scene, {10, -20}, spec.ifov_mrad(), {320, 240});
  EXPECT_NEAR(centre.x, 159.5 + 0.3 + 10 / (2 * spec.ifov_mrad()), 1e-12);
  EXPECT_NEAR(centre.y, 119.5 - 0.2 - 20 / (2 * spec.ifov_mrad()), 1e-12);
  const ImageChain chain(spec, full_plan(spec, {}, {}), Accuracy::reference());
  const cv::Point origin(static_cast<int>(centre.x) - 4, static_cast<int>(centre.y) - 4);
  const auto exact =
      chain.infinite_plane(triangle(3 / spec.ifov_mrad(), Apex::right), cv::Point2d(origin) - centre, 1, {9, 9});
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 9; ++i) {
      // Wrap tolerance of the normal level (1.5e-5), four wavelengths (2e-6) and single precision.
      EXPECT_NEAR(static_cast<double>((*picture)(origin.y + j, origin.x + i)), exact.values(j, i), 2.5e-5);
    }
  }
}

TEST(SensorModel, TemporalNoiseHasTheStatedSizeAndIsWhite) {
  SensorSpec spec = test::sc2000();
  PlateScene scene = scene_of_one();
  scene.delta_t_k = 0;
  const auto m = model(spec, {Effect::quantisation});

  const cv::Mat1f a = m.picture(scene, 0);
  const cv::Mat1f b = m.picture(scene, 1);

  const double n = 320 * 240;
  cv::Scalar mean, sd;
  cv::meanStdDev(a, mean, sd);
  EXPECT_NEAR(mean[0], 0, 4 * 0.07 / std::sqrt(n));
  EXPECT_NEAR(sd[0], 0.07, 4 * 0.07 / std::sqrt(2 * n));
  EXPECT_NEAR(a.dot(b) / n, 0, 4 * 0.07 * 0.07 / std::sqrt(n));
  double neighbour = 0;
  for (int row = 0; row < 240; ++row) {
    for (int column = 0; column + 1 < 320; ++column)
      neighbour += static_cast<double>(a(row, column)) * static_cast<double>(a(row, column + 1));
  }
  EXPECT_NEAR(neighbour / n, 0, 4 * 0.07 * 0.07 / std::sqrt(n));
}

TEST(SensorModel, CountsAreThePictureRoundedAndClipped) {
  SensorSpec spec = test::sc2000();
  const auto m = model(spec);
  const PlateScene scene = scene_of_one();

  const cv::Mat1w counts = m.expose(scene, 4);
  const cv::Mat1f picture = m.picture(scene, 4);

  for (int row = 0; row < 240; row += 7) {
    for (int column = 0; column < 320; column += 5) {
      const double kelvin = spec.offset_k + spec.kelvin_per_count * counts(row, column) - scene.background_k;
      EXPECT_NEAR(kelvin, static_cast<double>(picture(row, column)), 1e-4);
    }
  }
  PlateScene hot = scene;
  hot.background_k = 10'000;
  PlateScene cold = scene;
  cold.background_k = 10;
  EXPECT_EQ(m.expose(hot, 0)(5, 5), 16383);
  EXPECT_EQ(m.expose(cold, 0)(5, 5), 0);
}

TEST(SensorModel, EverySkippedEffectEqualsItsNeutralValueAndLeavesTheNoiseOfTheOthers) {
  SensorSpec spec = test::sc2000();
  spec.fixed_pattern_k = 0.05;
  spec.aberration_sigma_pitch = 0.2;
  const PlateScene scene = scene_of_one();
  const auto frame = [&](const SensorSpec& s, const std::vector<Effect>& skip, const std::vector<Effect>& force) {
    return model(s, skip, force).picture(scene, 11);
  };
  const auto same = [](const cv::Mat1f& a, const cv::Mat1f& b) { return cv::norm(a, b, cv::NORM_INF) == 0; };
  SensorSpec no_noise = spec, no_pattern = spec, no_aberration = spec;
  no_noise.netd_k = 0;
  no_pattern.fixed_pattern_k = 0;
  no_aberration.aberration_sigma_pitch = 0;

  EXPECT_TRUE(same(frame(spec, {Effect::temporal_noise}, {}), frame(no_noise, {}, {Effect::temporal_noise})));
  EXPECT_TRUE(same(frame(spec, {Effect::fixed_pattern}, {}), frame(no_pattern, {}, {Effect::fixed_pattern})));
  EXPECT_TRUE(same(frame(spec, {Effect::aberration}, {}), frame(no_aberration, {}, {Effect::aberration})));

  // Without the fixed pattern the temporal noise is what it was: the difference is the pattern alone, the same in every
  // frame.
  const auto with = model(spec, {Effect::quantisation});
  const auto without = model(spec, {Effect::quantisation, Effect::fixed_pattern});
  const cv::Mat1f pattern_3 = with.picture(scene, 3) - without.picture(scene, 3);
  const cv::Mat1f pattern_9 = with.picture(scene, 9) - without.picture(scene, 9);
  EXPECT_LT(cv::norm(pattern_3, pattern_9, cv::NORM_INF), 1e-5);
  cv::Scalar mean, sd;
  cv::meanStdDev(pattern_3, mean, sd);
  EXPECT_NEAR(sd[0], 0.05, 4 * 0.05 / std::sqrt(2 * 320.0 * 240.0));
}

TEST(SensorModel, MicroscanSharesTheFixedPatternOfADetectorAmongItsSamples) {
  SensorSpec spec = test::sc2000();
  spec.width = 32;
  spec.height = 24;
  spec.fixed_pattern_k = 0.05;
  spec.microscan = 2;
  const auto m = model(spec, {Effect::temporal_noise, Effect::quantisation});
  PlateScene scene = scene_of_one();
  scene.delta_t_k = 0;

  const cv::Mat1f picture = m.picture(scene, 0);

  ASSERT_EQ(picture.size(), cv::Size(64, 48));
  EXPECT_EQ(picture(10, 20), picture(11, 21));
  EXPECT_EQ(picture(10, 20), picture(10, 21));
  EXPECT_NE(picture(10, 20), picture(10, 22));
}

}  // namespace
}  // namespace todbench
