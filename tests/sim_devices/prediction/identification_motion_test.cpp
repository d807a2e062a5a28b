// SPDX-License-Identifier: GPL-3.0-or-later
// Identification of targets in motion: what must equal targets at rest, closed forms, and what speed costs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "hvs/observer/template_bank.h"
#include "sim_devices/prediction/identification.h"
#include "sim_devices/sensor/effect_readout.h"
#include "sim_devices/sensor/image_chain.h"
#include "tests/sim_devices/reference.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

FieldScene triangle_in_field(Apex apex, double temperature_k = 300.3) {
  FieldScene scene;
  scene.background_k = 300;
  scene.regions = {{"triangle", triangle(1, apex), temperature_k, 1, true}};
  return scene;
}

/// Two triangles of 1 m at a known place, in front of a detector with memory and exposure.
IdentificationTask two_in_motion(SceneMotion motion) {
  IdentificationTask task;
  task.sensor = test::sc2000();
  task.sensor.time_constant_ms = 8;
  task.sensor.exposure_ms = 10;
  task.motion = motion;
  task.plan = full_plan(task.sensor, {}, {}, motion);
  task.observer.search_range_samples = 0;
  task.knowledge = TemplateKnowledge::ideal;
  task.accuracy = Accuracy::draft();
  task.targets = {{"up", {triangle_in_field(Apex::up)}}, {"right", {triangle_in_field(Apex::right)}}};
  task.ranges = {{350, 1}};
  task.decisions = 1200;
  return task;
}

// The frames of a pass go another way than the scores of a still picture: noise and target are judged together.
TEST(IdentificationInMotion, OfPassesAtRestAreTheAnswersToOnePicture) {
  IdentificationTask task = two_in_motion({});
  task.observer.search_range_samples = 0.5;
  task.sensor.fixed_pattern_k = 0.03;
  task.plan = full_plan(task.sensor, {}, {});
  const auto still = identify(task);
  ASSERT_TRUE(still) << still.error().message;
  for (const SequenceObserver sequence : {SequenceObserver::static_sum, SequenceObserver::tracking_sum}) {
    IdentificationTask one = task;
    one.sequence = sequence;
    one.frames = 1;
    const auto found = identify(one);
    ASSERT_TRUE(found) << found.error().message;
    if (sequence == SequenceObserver::static_sum) {
      EXPECT_EQ(found->front().answers, still->front().answers);
    } else {
      // A search centred on the true place is one of the same width elsewhere.
      EXPECT_NEAR(found->front().proportion(), still->front().proportion(), 0.04);
    }
    one.frames = 6;
    const auto summed = identify(one);
    ASSERT_TRUE(summed) << summed.error().message;
    EXPECT_GT(summed->front().proportion(), still->front().proportion()) << "noise falls with the number of frames";
  }
  EXPECT_LT(still->front().proportion(), 0.97);
}

/// Two alternatives at a known place: the mean score difference of the frames is normal.
double closed_form(const IdentificationTask& task, double contrast_k) {
  const SensorSpec& spec = task.sensor;
  const double size_pitch = 1e3 / (task.ranges.front().range_m * spec.ifov_mrad());
  const bool tracks = task.sequence == SequenceObserver::tracking_sum;
  const int frames = tracks ? task.frames : 1;
  TemplateObserverSpec wide = task.observer;
  wide.search_range_samples = 0.5;
  const auto bank = TemplateBank::build(wide, {triangle(1, Apex::up), triangle(1, Apex::right)}, size_pitch, 1);
  const int side = bank->window_samples(), middle = 40;  // of 9 x 9 places
  const double white_k2 = spec.netd_k * spec.netd_k + spec.kelvin_per_count * spec.kelvin_per_count / 12;
  const ImageChain chain(spec, task.plan, task.accuracy, task.motion);
  const auto difference = [&](int place) { return cv::Mat1f(bank->image(0, place) - bank->image(1, place)); };
  const double step = task.motion.x_mrad_s / spec.ifov_mrad() / spec.frame_rate_hz;
  double sum = 0;
  for (int phase = 0; phase < 16; ++phase) {
    for (const bool up : {true, false}) {
      double signal = 0,
             variance = std::pow(task.observer.internal_noise * contrast_k * cv::norm(difference(middle)), 2);
      for (int k = 0; k < frames; ++k) {
        cv::Point2d at((phase % 4 + 0.5) / 4 - 0.5 + step * k, (phase / 4 + 0.5) / 4 - 0.5);
        at.x -= std::floor(at.x + 0.5);
        const int place =
            tracks ? middle + static_cast<int>(std::lround(at.x * 8) + 9 * std::lround(at.y * 8)) : middle;
        cv::Mat1f seen;
        chain.image(triangle(size_pitch, up ? Apex::up : Apex::right))
            .sample(cv::Point2d(0.5 - side / 2.0, 0.5 - side / 2.0) - at, 1, {side, side})
            .convertTo(seen, CV_32F, contrast_k);
        signal += (up ? 1 : -1) * difference(place).dot(seen) / frames;
        variance += white_k2 * std::pow(cv::norm(difference(place)) / frames, 2);
      }
      sum += 0.5 * std::erfc(-signal / std::sqrt(2 * variance)) / 32;
    }
  }
  return sum;
}

TEST(IdentificationInMotion, OfTwoTrianglesIsTheClosedFormBehindTheTransferOfTheMotion) {
  double before = 1;
  for (const double speed_mrad_s : {0.0, 60.0, 120.0, 200.0}) {
    for (const SequenceObserver sequence : {SequenceObserver::single_frame, SequenceObserver::tracking_sum}) {
      SCOPED_TRACE(speed_mrad_s);
      SCOPED_TRACE(to_string(sequence));
      IdentificationTask task = two_in_motion({.x_mrad_s = speed_mrad_s, .y_mrad_s = 0});
      task.sequence = sequence;
      task.frames = 4;
      if (sequence == SequenceObserver::tracking_sum) task.ranges = {{500, 1}};
      const double expected = closed_form(task, 0.3);

      const auto found = identify(task);

      ASSERT_TRUE(found) << found.error().message;
      EXPECT_GT(expected, 0.55);
      EXPECT_LT(expected, 0.99);
      // Four standard errors, and 0.003 for radiance that is not straight and for periods.
      EXPECT_NEAR(found->front().proportion(), expected, 4 * found->front().standard_error() + 0.003);
      if (sequence == SequenceObserver::single_frame) {
        EXPECT_LT(expected, before) << "speed costs";
        before = expected;
      }
    }
  }
}

// The same random numbers at every speed: for each knowledge of the targets the proportion falls with the speed.
TEST(IdentificationInMotion, FallsWithTheSpeed) {
  for (const TemplateKnowledge knowledge :
       {TemplateKnowledge::behind_camera, TemplateKnowledge::behind_camera_at_rest}) {
    std::vector<double> proportions;
    for (const double speed_mrad_s : {0.0, 80.0, 160.0, 320.0}) {
      IdentificationTask task = two_in_motion({.x_mrad_s = speed_mrad_s, .y_mrad_s = 0});
      task.observer.search_range_samples = 0.5;
      task.knowledge = knowledge;
      const auto found = identify(task);
      ASSERT_TRUE(found) << found.error().message;
      proportions.push_back(found->front().proportion());
    }
    for (std::size_t i = 1; i < proportions.size(); ++i) EXPECT_LT(proportions[i], proportions[i - 1]) << i;
  }
}

// Rows that are read one after the other show a sheared target: as a target at rest that has this shape.
TEST(IdentificationInMotion, ReadRowByRowIsThatOfShearedTargets) {
  IdentificationTask task = two_in_motion({.x_mrad_s = 200, .y_mrad_s = -90});
  task.sensor.time_constant_ms = task.sensor.exposure_ms = 0;
  task.sensor.row_time_us = 80;
  task.plan = full_plan(task.sensor, {}, {}, task.motion);
  task.knowledge = TemplateKnowledge::behind_camera;
  IdentificationTask sheared = task;
  sheared.motion = {};
  sheared.plan = full_plan(task.sensor, {}, {});
  const cv::Point2d slope = readout_slope(task.sensor, task.motion);
  ASSERT_GT(std::abs(slope.x), 0.01);
  for (auto& target : sheared.targets) {
    for (cv::Point2d& corner : target.aspects.front().regions.front().outline_m) corner = as_read_out(corner, slope, 0);
  }

  const auto found = identify(task), expected = identify(sheared);
  task.motion = {};
  const auto at_rest = identify(task);

  ASSERT_TRUE(found && expected && at_rest);
  EXPECT_EQ(found->front().answers, expected->front().answers);
  EXPECT_NE(found->front().answers, at_rest->front().answers);
}

// A target that leaves its place makes the mean of the frames useless; pursuit does not mind.
TEST(IdentificationInMotion, NeedsPursuitWhereTheTargetLeavesItsPlace) {
  IdentificationTask task = two_in_motion({.x_mrad_s = 130, .y_mrad_s = 0});
  task.sensor.time_constant_ms = task.sensor.exposure_ms = 0;
  task.plan = full_plan(task.sensor, {}, {}, task.motion);
  task.decisions = 640;
  task.ranges = {{400, 1}};
  task.sequence = SequenceObserver::static_sum;
  const auto staring = identify(task);
  task.sequence = SequenceObserver::tracking_sum;
  const auto pursuing = identify(task);

  ASSERT_TRUE(staring && pursuing);
  EXPECT_GT(pursuing->front().proportion(), staring->front().proportion() + 0.1);
}

TEST(IdentificationInMotion, RefusesWhatItDoesNotSimulate) {
  IdentificationTask fast = two_in_motion({.x_mrad_s = 1000, .y_mrad_s = 0});
  IdentificationTask nan = two_in_motion({.x_mrad_s = std::numeric_limits<double>::quiet_NaN(), .y_mrad_s = 0});
  IdentificationTask microscan = two_in_motion({.x_mrad_s = 10, .y_mrad_s = 0});
  microscan.sensor.microscan = 2;
  microscan.plan = full_plan(microscan.sensor, {}, {}, microscan.motion);
  IdentificationTask resolved = two_in_motion({.x_mrad_s = 10, .y_mrad_s = 0});
  resolved.sequence = SequenceObserver::super_resolution;
  for (const IdentificationTask& task : {fast, nan, microscan, resolved}) {
    const auto found = identify(task);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  }
}

}  // namespace
}  // namespace todbench
