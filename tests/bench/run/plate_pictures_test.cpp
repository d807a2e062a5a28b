// SPDX-License-Identifier: GPL-3.0-or-later
// The picture of the plate beside that of its model, and pictures in the record of a session.
#include "bench/devices/plate_picture.h"

#include <gmock/gmock.h>

#include <memory>

#include "bench/plan/descriptions.h"
#include "bench/session/measure_pictures.h"
#include "bench/session/measures_record.h"
#include "bench/text/base64.h"
#include "tests/bench/run/measures_plan.h"

namespace todbench {
namespace {

using testing::measures_plan;

/// The plate as a sensor with noise sees it, the mean of 16 frames, found at the place where it is.
PlateView seen_by(const SensorSpec& sensor, const TargetPlate& plate, std::uint64_t seed) {
  const SensorModel model(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), seed);
  PlateScene scene;
  scene.plate = plate;
  scene.delta_t_k = 4;
  scene.rotation_deg = 0.7;
  PlateView seen;
  seen.frames = 16;
  seen.set_delta_t_k = 4;
  seen.picture = model.size();
  seen.field = {120, 65, 75, 110};
  seen.temporal_noise_k = sensor.netd_k;
  cv::Mat1f mean(model.size(), 0.0F);
  for (int k = 0; k < seen.frames; ++k) mean += model.picture(scene, static_cast<std::uint64_t>(k)) / seen.frames;
  mean(seen.field).convertTo(seen.kelvin, CV_64F);
  // Found a little beside the truth, as a registration does.
  const double scale = 1.0005 / (scene.distance_m * sensor.ifov_mrad());
  const double angle = 0.71 * std::numbers::pi / 180;
  const cv::Point2d middle = scene_pixel(scene, {0, 0}, sensor.ifov_mrad(), model.size()) + cv::Point2d(0.02, -0.01);
  seen.where.plate_to_pixel = {scale * std::cos(angle),
                               -scale * std::sin(angle),
                               middle.x,
                               scale * std::sin(angle),
                               scale * std::cos(angle),
                               middle.y,
                               0,
                               0,
                               1};
  seen.where.scale_px_per_mm = scale;
  seen.where.rotation_deg = 0.71;
  return seen;
}

TEST(PlatePictures, LeaveTheNoiseOfARightModelAndMoreThanThatOfAWrongOne) {
  const TargetPlate plate = *load_plate("tcat-a");
  const SensorSpec right = *load_sensor("sc2000");
  SensorSpec wrong = right, other_size = right;
  wrong.aberration_sigma_pitch = 0.5;
  other_size.width = 160;
  const auto model = [](const SensorSpec& sensor) {
    return std::make_unique<SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  };
  int within = 0;
  constexpr int seeds = 20;
  for (std::uint64_t seed = 11; seed < 11 + seeds; ++seed) {
    const PlateView seen = seen_by(right, plate, seed);
    const auto picture = plate_picture(seen, plate, *model(right), {});
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_NEAR(picture->contrast_k, 4, 0.02);
    EXPECT_NEAR(picture->moved_px, std::hypot(0.02, 0.01), 0.01);
    EXPECT_EQ(picture->outlines.size(), plate.triangles.size());
    // White noise of the sensor and of rounding to its counts.
    const double expected = std::hypot(1, right.kelvin_per_count / std::sqrt(12.0) / right.netd_k);
    const double relative = 1.96 / std::sqrt(2.0 * static_cast<double>(seen.kelvin.total()));
    within += std::abs(picture->residual_over_noise().value() / expected - 1) < relative ? 1 : 0;
  }
  // 20 seeds at 95 %: fewer than 15 come by chance once in 3000.
  EXPECT_GE(within, 15);
  const PlateView seen = seen_by(right, plate, 3);
  const auto apart = plate_picture(seen, plate, *model(wrong), {});
  ASSERT_TRUE(apart) << apart.error().message;
  EXPECT_GT(apart->residual_over_noise().value(), 2);
  EXPECT_FALSE(plate_picture(seen, plate, *model(other_size), {}));
}

TEST(PlatePictures, OfARecordAreBase64AndNothingElse) {
  EXPECT_EQ(base64("Man"), "TWFu");
  EXPECT_EQ(base64("Ma"), "TWE=");
  EXPECT_EQ(base64("M"), "TQ==");
  for (const char* good : {"TWFu", "TWE=", "TQ==", "+/+/"}) EXPECT_TRUE(is_base64(good)) << good;
  for (const char* bad : {"", "TWF", "T===", "TW=u", "\"/><script>", "TWFu\n"}) EXPECT_FALSE(is_base64(bad)) << bad;
  CameraMeasures measures;
  measures.picture = PlatePicture{};
  measures.picture->seen.kelvin = cv::Mat1d(4, 5, 300.0);
  measures.picture->seen.kelvin(1, 1) = 301;
  measures.picture->expected_k = cv::Mat1d(4, 5, 300.0);
  Json record = measures_json(measures, std::nullopt);
  ASSERT_TRUE(measures_from(record));
  record["main"]["picture"]["seen_png"] = "\"/><script>";
  EXPECT_FALSE(measures_from(record));
}

}  // namespace
}  // namespace todbench
