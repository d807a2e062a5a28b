// SPDX-License-Identifier: GPL-3.0-or-later
// A monitor before the camera.
#include "bench/devices/display_target.h"

#include <gmock/gmock.h>

#include <cmath>

#include "hvs/shape/polygon.h"
#include "sim_devices/sensor/scene_image.h"
#include "sim_devices/sensor/sensor_model.h"

namespace todbench {
namespace {

TargetPlate plate_of_two() {
  TargetPlate plate;
  plate.name = "two";
  plate.width_mm = plate.height_mm = 40;
  plate.triangles = {{.name = "a", .position_mm = {-8, 3}, .size_mm = 10, .apex = Apex::up},
                     {.name = "b", .position_mm = {9, -4}, .size_mm = 5, .apex = Apex::left}};
  return plate;
}

DisplayTargetOptions options_of(double pixel_mm) {
  return {.plates = {plate_of_two()},
          .display = {.size_px = {256, 256}, .pixel_mm = pixel_mm},
          .span_k = 10,
          .settle = std::chrono::milliseconds(0)};
}

TEST(PlatePicture, HasTheAreaOfItsTrianglesWhateverTheShift) {
  const DisplayGeometry display{.size_px = {256, 256}, .pixel_mm = 0.2};
  for (const cv::Point2d shift : {cv::Point2d(0, 0), cv::Point2d(0.07, -0.03), cv::Point2d(1.234, 2.5)}) {
    const auto picture = plate_picture(plate_of_two(), shift, display, 0, 1);
    ASSERT_TRUE(picture) << picture.error().message;
    EXPECT_NEAR(cv::sum(*picture)[0] * 0.2 * 0.2, 100 + 25, 1e-9);
  }
  EXPECT_FALSE(plate_picture(plate_of_two(), {30, 0}, display, 0, 1));
  EXPECT_FALSE(plate_picture(plate_of_two(), {0, 0}, display, 0, 1.1));
  EXPECT_FALSE(plate_picture(plate_of_two(), {0, 0}, {.size_px = {0, 5}}, 0, 1));
}

TEST(DisplayTarget, RefusesAScreenThatShowsSomethingElse) {
  double wrong = 0;
  const auto target = display_target(options_of(0.2), [&](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    cv::Mat1f seen = levels.clone();
    seen(100, 100) += static_cast<float>(wrong / 255);
    return seen;
  });

  EXPECT_TRUE(target->present({.plate = "two", .delta_t_k = 5}, {}));
  wrong = 0.4;
  EXPECT_TRUE(target->present({.plate = "two", .delta_t_k = 5}, {}));
  wrong = 1;
  const auto refused = target->present({.plate = "two", .delta_t_k = 5}, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::integrity);
  EXPECT_FALSE(target->present({.plate = "none", .delta_t_k = 5}, {}));
  EXPECT_FALSE(target->present({.plate = "two", .delta_t_k = 11}, {}));
}

TEST(DisplayTarget, SaysTheContrastOfTheLevelsThatItShows) {
  cv::Mat1f last;
  const auto target = display_target(options_of(0.2), [&](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    last = levels.clone();
    return last;
  });

  const auto said = target->present({.plate = "two", .delta_t_k = -3.33}, {});

  ASSERT_TRUE(said);
  double low = 0, high = 0;
  cv::minMaxLoc(last, &low, &high);
  EXPECT_NEAR(said->state.delta_t_k, -10 * (high - low), 1e-6);
  EXPECT_NEAR(said->state.delta_t_k, -3.33, 10.0 / 255 / 2);
  EXPECT_NEAR(std::round(255 * low), 255 * low, 1e-4) << "a whole level";
}

// Light is what a camera sees: of a monitor with gamma the light has the area of the triangles and the contrast stated.
TEST(DisplayTarget, DrawsLightByAreaOnAMonitorWithGamma) {
  cv::Mat1f last;
  auto options = options_of(0.2);
  options.tone.gamma = 2.2;
  const auto target = display_target(options, [&](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    last = levels.clone();
    return last;
  });
  for (const double contrast_k : {10.0, 5.0, -2.5}) {
    const auto said = target->present({.plate = "two", .delta_t_k = contrast_k, .shift_mm = {0.07, -0.03}}, {});
    ASSERT_TRUE(said) << said.error().message;
    cv::Mat1d light;
    cv::pow(cv::Mat1d(last), 2.2, light);
    const double area = cv::sum(light - light(0, 0))[0] * 0.2 * 0.2 / (said->state.delta_t_k / 10);
    EXPECT_NEAR(area, 100 + 25, 1e-3) << contrast_k << ": single precision";
    // Half a level of light at the bright end, 2.2 / 255 / 2 of the span.
    EXPECT_NEAR(said->state.delta_t_k, contrast_k, 10 * 2.2 / 255 / 2);
  }
  const DisplayLevels all = display_levels(1, {.gamma = 2.2});
  EXPECT_EQ(all.ground, 0);
  EXPECT_EQ(all.pattern, 255);
}

// A measured table, of no power: the light that its straight lines give has the area of the triangles, too.
TEST(DisplayTarget, DrawsLightByAreaOnAMonitorWithAMeasuredTable) {
  const std::vector<double> table{0.5, 2.5, 12, 34, 90, 130};  // cd/m2 at 0, 51, ... 255: steep in the middle
  const auto light_of = [&](double level) {
    for (std::size_t i = 1; i < table.size(); ++i) {
      if (level <= 51.0 * static_cast<double>(i) + 1e-9)
        return table[i] - (51.0 * static_cast<double>(i) - level) / 51 * (table[i] - table[i - 1]);
    }
    return table.back();
  };
  cv::Mat1f last;
  auto options = options_of(0.2);
  options.tone.luminance = table;
  const auto target = display_target(options, [&](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    last = levels.clone();
    return last;
  });
  for (const double contrast_k : {10.0, 5.0, -2.5}) {
    const auto said = target->present({.plate = "two", .delta_t_k = contrast_k, .shift_mm = {0.07, -0.03}}, {});
    ASSERT_TRUE(said) << said.error().message;
    cv::Mat1d light(last.size());
    for (int row = 0; row < last.rows; ++row)
      for (int column = 0; column < last.cols; ++column) light(row, column) = light_of(255 * last(row, column));
    const double of_white = (table.back() - table.front()) / 10;  // a kelvin
    const double area = cv::sum(light - light(0, 0))[0] * 0.2 * 0.2 / of_white / said->state.delta_t_k;
    EXPECT_NEAR(area, 100 + 25, 2e-3) << contrast_k << ": single precision";
    // Half a level of light where the table is steepest.
    EXPECT_NEAR(said->state.delta_t_k, contrast_k, 56.0 / 51 / of_white / 2);
  }
  const DisplayTone tone{.luminance = table};
  for (const double light : {0.0, 0.01, 0.3, 0.77, 1.0}) EXPECT_NEAR(tone.light_of(tone.level_of(light)), light, 1e-14);
}

// What docs/reference/instruments.md says of a gamma that nobody stated: at gamma 2 the contrast c stays, and the edges
// of the bright side go back by c / 6 of a pixel.
TEST(DisplayTarget, WithoutItsGammaIsOffByAPartOfAPixelAtTheEdges) {
  cv::Mat1f last;
  const double pixel_mm = 0.1;
  auto options = options_of(pixel_mm);
  options.display.size_px = {512, 512};
  const auto target = display_target(options, [&](const cv::Mat1f& levels) -> Result<cv::Mat1f> {
    last = levels.clone();
    return last;
  });
  // Equilateral triangles of area s^2 have a perimeter of 4.559 s. Upright edges meet all pixels alike: the mean over
  // eight places in a pixel.
  constexpr double perimeter_mm = 4.559 * (10 + 5);
  constexpr int places = 8;
  for (const double c : {1.0, 0.6}) {
    double back_px = 0;
    for (int place = 0; place < places; ++place) {
      const double shift_mm = pixel_mm * place / places;
      ASSERT_TRUE(target->present({.plate = "two", .delta_t_k = 10 * c, .shift_mm = {shift_mm, shift_mm}}, {}));
      const cv::Mat1d light = cv::Mat1d(last).mul(cv::Mat1d(last));
      double low = 0, high = 0;
      cv::minMaxLoc(light, &low, &high);
      EXPECT_NEAR(high - low, c, 1e-5);
      const double area = cv::sum(light - low)[0] * pixel_mm * pixel_mm / (high - low);
      back_px += (125 - area) / perimeter_mm / pixel_mm / places;
    }
    EXPECT_NEAR(back_px, c / 6, 0.03 * c / 6) << "slanted edges 1 % less, corners and levels";
  }
}

// A camera before the monitor sees what it sees of the plate, but for the size of the monitor's pixels: squares of a
// tenth of a pitch blur by a variance of 1 / 1200 pitches squared, 1 / 130 of the detector's.
TEST(DisplayTarget, IsToACameraWhatThePlateIs) {
  SensorSpec spec;
  spec.width = spec.height = 32;
  const SensorPlan plan = full_plan(spec, {}, {});
  PlateScene scene;
  scene.plate = plate_of_two();
  scene.distance_m = 1;
  scene.centre_px = {0, 0};
  const SensorModel model(spec, plan, Accuracy::normal(), 1);
  const cv::Mat1f of_plate = *model.unit_signal(scene);
  cv::Mat1f levels;
  auto options = options_of(0.1 * spec.ifov_mrad());
  options.display.size_px = {320, 320};
  const auto target = display_target(options, [&](const cv::Mat1f& drawn) -> Result<cv::Mat1f> {
    levels = drawn.clone();
    return levels;
  });
  const auto said = target->present({.plate = "two", .delta_t_k = 10}, {});
  ASSERT_TRUE(said) << said.error().message;

  const cv::Mat1d above = cv::Mat1d(levels) - static_cast<double>(levels(0, 0));
  const cv::Mat1d of_display = SceneImager(spec, plan, Accuracy::normal())
                                   .image(above, 0.1, {(31 - 319 * 0.1) / 2, (31 - 319 * 0.1) / 2}, {32, 32});

  EXPECT_LT(cv::norm(cv::Mat1d(of_plate) - of_display, cv::NORM_INF), 4e-3);
}

}  // namespace
}  // namespace todbench
