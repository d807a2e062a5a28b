// SPDX-License-Identifier: GPL-3.0-or-later
// Motion, exposure, readout by rows and in fields, and displaced exposures against brute force.
#include "sim_devices/sensor/effect_motion.h"

#include <gmock/gmock.h>

#include <cmath>

#include "sim_devices/sensor/effect_exposure.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/sim_devices/prediction/effect_grid.h"
#include "tests/sim_devices/sensor/effect_scene.h"
#include "tod/registration/super_resolution.h"

namespace todbench {
namespace {

using test::scene;

TEST(Effects, MotionSmearsAlongItsWayAndLeavesTheCentroid) {
  // exp(-t) behind the target, its mean taken out: variance of the smear squared along the way, none across.
  const double s = 0.7, f = 1e-3;
  const auto h = motion_transfer(f, 0, {s, 0});
  EXPECT_NEAR(std::arg(h), 0, 1e-7);  // third cumulant: 2 (2 pi f s)^3 / 6
  EXPECT_NEAR(std::abs(h), 1 - 2 * std::pow(std::numbers::pi * f * s, 2), 1e-9);
  EXPECT_EQ(motion_transfer(0, f, {s, 0}), std::complex<double>(1, 0));
}

/// A plain sensor of 64 x 48 before the triangle of scene(), and one at rest of which brute force is made.
struct MovingPair {
  SensorSpec spec = test::sc2000();
  PlateScene moving = scene();
  MovingPair() {
    spec.width = 64;
    spec.height = 48;
  }
  [[nodiscard]] cv::Mat1f signal(const PlateScene& shown) const {
    return *SensorModel(spec, full_plan(spec, {}, {}, shown.motion), Accuracy::reference(), 1).unit_signal(shown);
  }
  [[nodiscard]] PlateScene still_at(cv::Point2d moved_px) const {
    PlateScene still = moving;
    still.motion = {};
    still.centre_px += moved_px;
    return still;
  }
};

TEST(Effects, AnExposureIsTheMeanOfWhatIsSeenMeanwhile) {
  MovingPair pair;
  pair.spec.exposure_ms = 20;  // 0.92 and 0.31 pitches
  const cv::Point2d way = exposure_way_pitch(pair.spec, pair.moving.motion);
  ASSERT_NEAR(way.x, 0.917, 1e-3);
  SensorSpec plain = pair.spec;
  plain.exposure_ms = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  cv::Mat1d sum(cv::Size(64, 48), 0.0);
  for (const auto& [x, weight] : gauss_legendre(40)) sum += weight / 2 * *still.unit_signal(pair.still_at(x / 2 * way));

  // Single precision and a wrap tolerance of 1.7e-6.
  cv::Mat1d exposed;
  pair.signal(pair.moving).convertTo(exposed, CV_64F);
  EXPECT_LT(cv::norm(exposed, sum, cv::NORM_INF), 1e-5);
  EXPECT_GT(cv::norm(exposed, cv::Mat1d(*still.unit_signal(pair.still_at({0, 0}))), cv::NORM_INF), 0.01);
}

TEST(Effects, RowsThatAreReadOneAfterTheOtherShowTheTargetWhereItIsThen) {
  MovingPair pair;
  pair.spec.row_time_us = 400;
  const cv::Point2d slope = readout_slope(pair.spec, pair.moving.motion);
  SensorSpec plain = pair.spec;
  plain.row_time_us = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  const cv::Mat1f by_rows = pair.signal(pair.moving);

  double largest = 0, moved = 0;
  for (int row = 0; row < 48; ++row) {
    const auto then = still.unit_signal(pair.still_at(slope * (row - 23.5)));
    largest = std::max(largest, cv::norm(by_rows.row(row), then->row(row), cv::NORM_INF));
    moved =
        std::max(moved, cv::norm(by_rows.row(row), still.unit_signal(pair.still_at({0, 0}))->row(row), cv::NORM_INF));
  }

  EXPECT_LT(largest, 1e-5);
  EXPECT_GT(moved, 0.01);
}

TEST(Effects, AnEdgeThatIsReadRowByRowLeansByTheSlope) {
  MovingPair pair;
  pair.moving.plate.triangles.clear();
  pair.moving.plate.rectangles = {{.name = "bar", .position_mm = {0, 0}, .size_mm = {40, 40}, .angle_deg = 5}};
  pair.moving.motion = {.x_mrad_s = 330, .y_mrad_s = 0};  // five pitches a frame
  pair.spec.row_time_us = 80;
  const cv::Point2d slope = readout_slope(pair.spec, pair.moving.motion);
  SensorSpec plain = pair.spec;
  plain.row_time_us = 0;
  const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);
  const cv::Mat1f by_rows = pair.signal(pair.moving);

  // Rectangles lean as a whole, their blur does not: a slope of 0.02 changes the width of the blur by its product with
  // the slope of the edge.
  for (int row = 18; row < 30; ++row) {
    const auto then = still.unit_signal(pair.still_at(slope * (row - 23.5)));
    EXPECT_LT(cv::norm(by_rows.row(row), then->row(row), cv::NORM_INF), 0.005) << row;
  }
}

TEST(Effects, FieldsShowTheTargetWhereItIsThen) {
  for (const int microscan : {1, 2}) {
    MovingPair pair;
    pair.moving.plate.rectangles = {{.name = "bar", .position_mm = {0, 0}, .size_mm = {40, 40}, .angle_deg = 5}};
    pair.spec.microscan = microscan;
    pair.spec.field_delay_ms = 10;
    const cv::Point2d way = way_between_fields(pair.spec, pair.moving.motion);
    ASSERT_NEAR(way.x, 0.458, 1e-3) << "pitches";
    SensorSpec plain = pair.spec;
    plain.field_delay_ms = 0;
    const SensorModel still(plain, full_plan(plain, {}, {}), Accuracy::reference(), 1);

    const cv::Mat1f interlaced = pair.signal(pair.moving);

    const auto early = still.unit_signal(pair.still_at(-0.5 * microscan * way));
    const auto late = still.unit_signal(pair.still_at(0.5 * microscan * way));
    for (int row = 0; row < interlaced.rows; ++row) {
      const cv::Mat1f& then = row / microscan % 2 == 0 ? *early : *late;
      EXPECT_LT(cv::norm(interlaced.row(row), then.row(row), cv::NORM_INF), 1e-5) << row;
    }
    EXPECT_GT(cv::norm(interlaced, *early, cv::NORM_INF), 0.1);
  }
}

TEST(Effects, FieldsOfATargetAtRestAreTheProgressiveFrameBitForBit) {
  MovingPair pair;
  const cv::Mat1f progressive = pair.signal(pair.still_at({0, 0}));
  pair.spec.field_delay_ms = 10;
  EXPECT_EQ(cv::norm(pair.signal(pair.still_at({0, 0})), progressive, cv::NORM_INF), 0);
}

TEST(Effects, TheLagOfTimeConstantAndExposureIsTheirMean) {
  SensorSpec spec = test::sc2000();
  spec.time_constant_ms = 12;
  spec.exposure_ms = 10;
  EXPECT_NEAR(mean_lag_pitch(spec, {.x_mrad_s = 100, .y_mrad_s = 0}).x, 0.1 * 17 / spec.ifov_mrad(), 1e-12);
}

TEST(Effects, SensorsThatExposeOrReadLongerThanAFrameAreRefused) {
  SensorSpec spec = test::sc2000();
  spec.exposure_ms = 20;
  spec.row_time_us = 83;
  EXPECT_TRUE(validate(spec));
  spec.exposure_ms = 20.1;
  EXPECT_FALSE(validate(spec));
  spec.exposure_ms = 0;
  spec.row_time_us = 84;
  EXPECT_FALSE(validate(spec));
  spec.row_time_us = 41;
  spec.field_delay_ms = 10;
  EXPECT_TRUE(validate(spec));
  spec.row_time_us = 42;
  EXPECT_FALSE(validate(spec));
}

TEST(Effects, SuperResolutionOfShiftedExposuresIsTheSimulatedPicture) {
  // Four frames displaced by half a pitch, put together by the free function, against the stage of the model.
  SensorSpec spec = test::sc2000();
  spec.width = 64;
  spec.height = 48;
  SensorSpec super = spec;
  super.super_resolution_frames = 4;
  PlateScene still = scene();
  still.motion = {};
  std::vector<cv::Mat1f> frames;
  std::vector<cv::Point2d> shifts;
  const SensorModel plain(spec, full_plan(spec, {}, {}), Accuracy::reference(), 1);
  for (const cv::Point2d shift :
       {cv::Point2d(0.25, 0.25), cv::Point2d(-0.25, 0.25), cv::Point2d(0.25, -0.25), cv::Point2d(-0.25, -0.25)}) {
    PlateScene moved = still;
    moved.centre_px += shift;
    frames.push_back(*plain.unit_signal(moved));
    shifts.push_back(shift);
  }

  const auto put_together = super_resolve(frames, shifts);
  PlateScene fine = still;
  fine.centre_px = 2 * still.centre_px;
  const auto stage = SensorModel(super, full_plan(super, {}, {}), Accuracy::reference(), 1).unit_signal(fine);

  ASSERT_TRUE(put_together.has_value());
  ASSERT_EQ(put_together->picture.size(), stage->size());
  const cv::Rect inside(4, 4, 120, 88);
  // Wrap tolerance 1.7e-6 and single precision.
  EXPECT_LT(cv::norm(put_together->picture(inside), (*stage)(inside), cv::NORM_INF), 5e-6);
}

}  // namespace
}  // namespace todbench
