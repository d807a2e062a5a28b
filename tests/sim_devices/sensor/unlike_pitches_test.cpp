// SPDX-License-Identifier: GPL-3.0-or-later
// Sensors whose pitch along y differs from that along x. A lattice with twice the pitch along y samples every second
// row of a square one with the same detectors: the pictures of the square one are the witness.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "acquisition/base/try.h"
#include "sim_devices/prediction/camera_trials.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/effect_distortion.h"
#include "sim_devices/sensor/image_chain.h"
#include "sim_devices/sensor/module_sensor.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/registration/registration.h"

namespace todbench {
namespace {

SensorSpec square_lattice() {
  SensorSpec spec;
  spec.name = "square";
  spec.width = 96, spec.height = 128;
  spec.pitch_um = 20, spec.detector_um = 18, spec.detector_y_um = 16;
  spec.focal_length_mm = 20;
  spec.f_number = 1.5;
  spec.aberration_sigma_pitch = 0.3;
  spec.halo_share = 0.04, spec.halo_sigma_pitch = 3;
  return spec;
}

SensorSpec every_second_row(SensorSpec spec) {
  spec.name = "tall";
  spec.pitch_y_um = 2 * spec.pitch_um;
  spec.height /= 2;
  return spec;
}

PlateScene scene_of(cv::Point2d centre_px) {
  PlateScene scene;
  scene.plate.name = "test";
  scene.plate.width_mm = 160, scene.plate.height_mm = 220;
  scene.plate.triangles = {{"large", {-20, -60}, 18, Apex::up},
                           {"right", {22, -40}, 9, Apex::right},
                           {"down", {18, 10}, 5, Apex::down},
                           {"left", {-20, 20}, 3, Apex::left}};
  scene.plate.rectangles = {{"frame", {0, 70}, {60, 24}}};
  scene.delta_t_k = 1;
  scene.distance_m = 2;
  scene.rotation_deg = 6;
  scene.centre_px = centre_px;
  return scene;
}

/// The largest difference between a picture and every second row of the other.
double difference(const cv::Mat1f& tall, const cv::Mat1f& square) {
  EXPECT_EQ(square.rows, 2 * tall.rows);
  double largest = 0;
  for (int row = 0; row < tall.rows; ++row)
    for (int x = 0; x < tall.cols; ++x)
      largest = std::max(largest, std::abs(static_cast<double>(tall(row, x) - square(2 * row, x))));
  return largest;
}

void expect_every_second_row(const SensorSpec& square, SceneMotion motion, double tolerance) {
  const SensorSpec tall = every_second_row(square);
  const auto picture = [&](const SensorSpec& spec, cv::Point2d centre_px) {
    const SensorModel model(spec, full_plan(spec, {}, {}, motion), Accuracy::reference(), 1);
    PlateScene scene = scene_of(centre_px);
    scene.motion = motion;
    return *model.unit_signal(scene);
  };
  // Row r of the tall lattice is row 2 r of the square one, whose middle is half a row further down.
  EXPECT_LT(difference(picture(tall, {0.3, 0.15}), picture(square, {0.3, 2 * 0.15 - 0.5})), tolerance);
}

TEST(UnlikePitches, PicturesAreEverySecondRowOfASquareLattice) {
  expect_every_second_row(square_lattice(), {}, 2e-4);
}

TEST(UnlikePitches, MotionIsInPitchesOfEachAxis) {
  SensorSpec spec = square_lattice();
  spec.time_constant_ms = 6;
  spec.exposure_ms = 4;
  expect_every_second_row(spec, {.x_mrad_s = 120, .y_mrad_s = 150}, 2e-4);
}

/// A shape that reaches far beyond the window: its tails are integrated in closed form, round in space.
TEST(UnlikePitches, TheTailsOfAHugeShapeAreRoundInSpace) {
  SensorSpec square = square_lattice();
  square.halo_share = 0;
  const SensorSpec tall = every_second_row(square);
  const double size_pitch = 400;
  const Polygon shape =
      triangle(size_pitch, Apex::up, {0.4, 0.3 - triangle_centroid_to_base * size_pitch});  // its base is in the window
  const auto plane = [&](const SensorSpec& spec, double first_y, int rows) {
    return ImageChain(spec, full_plan(spec, {}, {}), Accuracy::normal())
        .infinite_plane(on_detectors(shape, spec), {-3, first_y}, 1, {7, rows});
  };

  const auto of_square = plane(square, -4, 8), of_tall = plane(tall, -2, 4);

  EXPECT_LT(difference(cv::Mat1f(of_tall.values), cv::Mat1f(of_square.values)),
            of_square.max_error_estimate + of_tall.max_error_estimate);
  EXPECT_LT(of_tall.max_error_estimate, 1e-4);
  EXPECT_GT(of_tall.values(0, 3), 0.9);  // the window has inside and outside
  EXPECT_LT(of_tall.values(3, 3), 0.1);
}

TEST(UnlikePitches, DistortionIsRadialInTheImageOfTheLens) {
  SensorSpec square = square_lattice();
  square.distortion_percent = 4, square.distortion_r4_percent = -1;
  const SensorSpec tall = every_second_row(square);
  const cv::Size whole(96, 128), half(96, 64);
  const auto middle = [](cv::Size size) { return cv::Point2d(0.5 * (size.width - 1), 0.5 * (size.height - 1)); };
  for (const cv::Point2d from : {cv::Point2d(40, 50), {-30, 10}, {5, -60}}) {
    const cv::Point2d expected = as_lens_shows(middle(whole) + from, square, whole) - middle(whole);
    const cv::Point2d found = as_lens_shows(middle(half) + cv::Point2d(from.x, from.y / 2), tall, half) - middle(half);
    EXPECT_NEAR(found.x, expected.x, 1e-12);
    EXPECT_NEAR(found.y, expected.y / 2, 1e-12);
  }
}

TEST(UnlikePitches, ThePlateIsFoundAtItsScale) {
  SensorSpec spec = every_second_row(square_lattice());
  spec.width = 200, spec.height = 120;
  spec.pitch_y_um = 26, spec.halo_share = 0;
  const SensorModel model(spec, full_plan(spec, {}, {}), Accuracy::normal(), 1);
  PlateScene scene = scene_of({0.3, 0.2});
  scene.plate.rectangles.clear();
  scene.plate.triangles.clear();
  for (int i = 0; i < 12; ++i) {
    scene.plate.triangles.push_back({std::to_string(i),
                                     {60.0 * (i % 4 - 1.5), 60.0 * (i / 4 - 1)},
                                     10.0 + i % 3,
                                     static_cast<Apex>((i * 7 + i / 4) % 4)});
  }
  scene.rotation_deg = 3;
  const cv::Mat1d picture = *model.unit_signal(scene);
  RegistrationOptions options{.expected_scale_px_per_mm = 0.5, .pixel_aspect = 1.3};

  const auto found = register_plate(picture, scene.plate, options);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->mapping, PlateMapping::similarity);
  EXPECT_NEAR(found->scale_px_per_mm, 0.5, 1e-4);
  EXPECT_NEAR(found->rotation_deg, 3, 0.01);
  EXPECT_LT(found->residual_px, 0.02);
  for (const PlateTriangle& t : scene.plate.triangles) {
    const cv::Point2d truth = scene_pixel(scene, t.position_mm, sample_mrad(spec), model.size());
    EXPECT_LT(cv::norm(found->pixel(t.position_mm) - truth), 0.02) << t.name;
  }
  options.pixel_aspect = 1;
  const auto believed_square = register_plate(picture, scene.plate, options);
  ASSERT_FALSE(believed_square);
  EXPECT_THAT(believed_square.error().message, testing::HasSubstr("stretched"));
}

/// S75 in mrad from answers to frames, whose places and sizes are known.
Result<double> s75_of_frames(const SensorSpec& spec, const TemplateObserverSpec& observer_spec, int presentations) {
  TemplateObserver observer(observer_spec, triangle_alternatives());
  const CameraTrialOptions options{.delta_t_k = 1.5,
                                   .sizes_pitch = {1.2, 1.6, 2.0, 2.4, 3.0},
                                   .presentations = presentations,
                                   .frames = 4,
                                   .accuracy = Accuracy::normal(),
                                   .seed = 5};
  TODBENCH_TRY(const auto record, camera_trials(spec, {&observer}, options));
  TODBENCH_TRY(const auto fit, fit_graded(record.observers[0].still.graded, {}));
  return *fit.threshold;
}

TEST(UnlikePitches, DirectEstimateIsThatOfAnswersToFrames) {
  for (const double pitch_y_um : {34.0, 60.0}) {
    SensorSpec spec;
    spec.name = "unlike";
    spec.pitch_y_um = pitch_y_um;
    spec.detector_y_um = 0.9 * pitch_y_um;
    TemplateObserverSpec seeing{.sample_aspect = spec.pitch_aspect()};
    TemplateObserver observer(seeing, triangle_alternatives());
    const auto direct =
        direct_estimate(spec, full_plan(spec, {}, {}), observer, {1.5}, {.accuracy = Accuracy::normal(), .seed = 3});
    ASSERT_TRUE(direct) << direct.error().message;
    const double expected_mrad = (*direct)[0].s75_pitch * spec.ifov_mrad();

    const auto found = s75_of_frames(spec, seeing, 24);

    ASSERT_TRUE(found) << found.error().message;
    EXPECT_NEAR(*found / expected_mrad, 1, 0.04) << pitch_y_um;
  }
}

TEST(UnlikePitches, TheObserverNeedsSamplesOfThatShape) {
  SensorSpec spec;
  spec.name = "unlike";
  spec.pitch_y_um = 60;
  TemplateObserver observer({}, triangle_alternatives());

  const auto found = direct_estimate(spec, full_plan(spec, {}, {}), observer, {1.5}, {.accuracy = Accuracy::draft()});

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(found.error().message, testing::HasSubstr("pitches of sensor unlike differ by a factor of 1.26"));
}

TEST(UnlikePitches, ImpossibleOnesAreRejected) {
  const auto message = [](double pitch_y_um, double detector_y_um) {
    SensorSpec spec;
    spec.name = "unlike";
    spec.pitch_y_um = pitch_y_um, spec.detector_y_um = detector_y_um;
    const auto valid = validate(spec);
    return valid ? std::string() : valid.error().message;
  };
  EXPECT_EQ(message(47.5, 0), "");
  EXPECT_EQ(message(60, 58), "");
  EXPECT_THAT(message(40, 0), testing::HasSubstr("detector_um is larger than pitch_y_um: state detector_y_um"));
  EXPECT_THAT(message(60, 61), testing::HasSubstr("detector_y_um is larger than the pitch along y"));
  EXPECT_THAT(message(96, 0), testing::HasSubstr("more than twice pitch_um"));
  EXPECT_THAT(message(23, 20), testing::HasSubstr("less than half"));
}

}  // namespace
}  // namespace todbench
