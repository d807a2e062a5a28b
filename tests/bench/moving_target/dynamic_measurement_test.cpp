// SPDX-License-Identifier: GPL-3.0-or-later
// Before a target that moves: at rest it is the static measurement, a lag is found.
#include "bench/moving_target/dynamic_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bench/plan/descriptions.h"
#include "bench/plan/plan.h"
#include "tests/bench/enhance/enhancement_support.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tod/plate/test_pattern.h"

namespace todbench {
namespace {

using testing::TemporaryFolder;
using namespace testing_support;

/// Remembers what was presented.
class RememberingTarget final : public Target {
 public:
  explicit RememberingTarget(Target& target) : target_(target) {}
  [[nodiscard]] const TargetCapabilities& capabilities() const override { return target_.capabilities(); }
  [[nodiscard]] Result<PresentedTarget> present(const TargetState& state, std::stop_token stop) override {
    states.push_back(state);
    return target_.present(state, stop);
  }
  [[nodiscard]] MovingTarget* moving() override { return target_.moving(); }
  std::vector<TargetState> states;

 private:
  Target& target_;
};

TEST(MovingMeasurement, OfAPlateAtRestIsTheStaticOneBitForBit) {
  // Without noise a frame does not depend on its number: every window, its phase and its answer has to be the same.
  const LoadedPlan plan = small_plan("16.9", 2);
  SensorSpec sensor = plan.sensor();
  sensor.netd_k = 0;
  TemplateObserverSpec spec;
  spec.internal_noise = 0;
  TemplateObserver observer(spec, triangle_alternatives());
  const auto model = std::make_shared<const SensorModel>(sensor, full_plan(sensor, {}, {}), Accuracy::draft(), 1);
  OpenedBench moving = simulated_bench(model, plan.plates(), 2, {}),
              still = simulated_bench(model, plan.plates(), 2, {});
  RememberingTarget target(*moving.target);
  MeasurementOptions at_rest = measurement_options(plan.plan(), plan.plates(), sensor.ifov_mrad());
  at_rest.frames_after_change = 0;
  at_rest.integrity.reject_frozen = false;
  MovingMeasurementOptions options{.measurement = at_rest,
                                   .mountings = {Mounting::identity},
                                   .delta_t_k = {16.9},
                                   .speeds_mrad_s = {0},
                                   .passes = 3,
                                   .frames = 2};

  const auto found = measure_moving(*moving.camera, target, observer, options, *moving.host, {}, {});
  ASSERT_TRUE(found) << found.error().message;
  ListedSchedule schedule({target.states.begin() + 1, target.states.end()});  // one at the place of the registration
  const auto measured = measure(*still.camera, *still.target, observer, schedule, at_rest, *still.host, {}, {});

  ASSERT_TRUE(measured) << measured.error().message;
  const std::size_t triangles = plan.plates()[0].triangles.size();
  ASSERT_EQ(measured->trials.size(), 4 * triangles);
  std::vector<Trial> answers;
  for (const MovingAnswer& answer : found->answers) {
    if (answer.observer == SequenceObserver::single_frame) answers.push_back(answer.trial);
  }
  ASSERT_EQ(answers.size(), 3 * triangles);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    const Trial& same = measured->trials[triangles + i];
    EXPECT_EQ(answers[i].triangle, same.triangle);
    EXPECT_EQ(answers[i].answer, same.answer);
    EXPECT_EQ(answers[i].delta_t_k, same.delta_t_k);
    EXPECT_EQ(answers[i].phase_x_px, same.phase_x_px);
    EXPECT_EQ(answers[i].phase_y_px, same.phase_y_px);
  }
}

std::string bolometer(const TemporaryFolder& folder) {
  std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  return folder.write("bolometer.toml", text + "\ntime_constant_ms = 12\nexposure_ms = 4\n").string();
}

TEST(MovingMeasurement, OfASimulatedSensorFindsItsTimeConstantAndLosesAcuityWithSpeed) {
  const TemporaryFolder folder;
  Plan plan =
      small_plan("16.9", 2, "[motion]\nspeeds_mrad_s = [30, 90]\npasses = 4\nframes = 4\nlead_frames = 2\n").plan();
  plan.simulation.sensor = bolometer(folder);
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = measure_dynamic(*loaded, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->time_constant.has_value());
  EXPECT_EQ(found->time_constant->passes, 8);
  EXPECT_NEAR(found->time_constant->time_constant_ms, 12, 0.6) << "5 %";
  EXPECT_LT(found->residual_px, 0.05);
  ASSERT_EQ(found->contrasts.size(), 1u);
  const auto& speeds = found->contrasts[0].speeds;
  ASSERT_EQ(speeds.size(), 3u);
  EXPECT_EQ(speeds[0].speed_mrad_s, 0);
  EXPECT_EQ(speeds[0].points[0].ratio.value_or(0), 1);
  const auto right = [&](double speed) {
    double correct = 0, total = 0;
    for (const MovingAnswer& answer : found->measured.answers) {
      if (answer.speed_mrad_s != speed || answer.observer != SequenceObserver::tracking_sum) continue;
      correct += answer.trial.correct() ? 1 : 0;
      total += 1;
    }
    return correct / total;
  };
  EXPECT_GT(right(0), right(90));
}

TEST(MovingMeasurement, ResolvesMoreWhereTheFramesOfAPassShowOtherPlaces) {
  // Half a pixel from frame to frame: the finer picture is full along the motion. The simulation of the same passes
  // knows the places; here they are those of the large triangles in each frame.
  const LoadedPlan plan =
      small_plan("16.9", 2, "[motion]\nspeeds_mrad_s = [32.7]\npasses = 12\nframes = 4\nlead_frames = 1\n");

  const auto found = measure_dynamic(plan, {}, {});
  TemplateObserver observer(plan.observer(), triangle_alternatives());
  const auto simulated = dynamic_acuity(plan.sensor(), observer,
                                        {.delta_t_k = 16.9,
                                         .sizes_pitch = {},
                                         .speeds_mrad_s = {32.7},
                                         .passes = 48,
                                         .frames = 4,
                                         .accuracy = Accuracy::draft()});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(simulated) << simulated.error().message;
  constexpr auto kind = static_cast<std::size_t>(SequenceObserver::super_resolution);
  const DynamicPoint& seen = found->contrasts.at(0).speeds.at(1).points.at(kind);
  const DynamicPoint& expected = simulated->speeds.at(1).points.at(kind);
  EXPECT_EQ(seen.observer, SequenceObserver::super_resolution);
  ASSERT_TRUE(seen.ratio_ci95.low && expected.ratio_ci95.low);
  EXPECT_GT(*seen.ratio_ci95.low, 1);
  EXPECT_GT(*expected.ratio_ci95.low, 1);
  const auto half_width = [](const DynamicPoint& p) { return std::log(*p.ratio_ci95.high / *p.ratio_ci95.low) / 2; };
  EXPECT_LT(std::abs(std::log(*seen.ratio / *expected.ratio)), std::hypot(half_width(seen), half_width(expected)))
      << *seen.ratio << " " << *expected.ratio;
}

/// A sample of 2.9 arcmin.
ViewedDisplay bench_display() {
  return {.pixel_pitch_mm = 0.25,
          .viewing_distance_m = 0.6,
          .luminance_white_cd_m2 = 200,
          .luminance_black_cd_m2 = 0.5,
          .zoom = 2};
}

void expect_spreads(const std::vector<DynamicAcuity>& speeds) {
  ASSERT_EQ(speeds.size(), 2u);
  int spreads = 0, ratios = 0;
  for (const DynamicAcuity& at : speeds) {
    for (const DynamicPoint& point : at.points) {
      if (!point.s75_spread_mrad) continue;
      ++spreads;
      EXPECT_LT(point.s75_spread_mrad->first, *point.fit.threshold) << at.speed_mrad_s;
      EXPECT_GT(point.s75_spread_mrad->second, *point.fit.threshold) << at.speed_mrad_s;
      if (!point.ratio_spread) continue;
      ++ratios;
      EXPECT_LE(point.ratio_spread->first, *point.ratio);
      EXPECT_GE(point.ratio_spread->second, *point.ratio);
    }
  }
  EXPECT_GE(spreads, 3);
  EXPECT_GE(ratios, 1);
}

TEST(MovingMeasurement, ByAnObserverWithAnEyeStatesItsOpenParametersFromTheSameFrames) {
  Plan plan = small_plan("0.5", 2, "[motion]\nspeeds_mrad_s = [40]\npasses = 4\nframes = 2\nlead_frames = 1\n").plan();
  plan.observer = "hvs-2";
  plan.display = bench_display();
  const auto loaded = LoadedPlan::load(plan);
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = measure_dynamic(*loaded, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const MovingMeasurement& measured = found->measured;
  ASSERT_GT(measured.answers.size(), 100u);
  double right[3] = {};
  for (std::size_t i = 0; i < measured.answers.size(); ++i) {
    right[0] += measured.answers_at_ends[0].at(i).trial.correct() ? 1 : 0;
    right[1] += measured.answers[i].trial.correct() ? 1 : 0;
    right[2] += measured.answers_at_ends[1].at(i).trial.correct() ? 1 : 0;
    EXPECT_EQ(measured.answers_at_ends[0][i].trial.truth, measured.answers[i].trial.truth);
  }
  EXPECT_GT(right[0], right[1]);
  EXPECT_GT(right[1], right[2]);
  expect_spreads(found->contrasts[0].speeds);
}

TEST(DynamicAcuity, OfAnObserverWithAnEyeStatesItsOpenParameters) {
  TemplateObserver observer(*load_observer_at("hvs-2", bench_display()), triangle_alternatives());
  const DynamicTrialOptions options{.delta_t_k = 0.5,
                                    .sizes_pitch = {1.2, 1.8, 2.7, 4, 6},
                                    .speeds_mrad_s = {40},
                                    .passes = 4,
                                    .frames = 2,
                                    .accuracy = Accuracy::draft()};
  const SensorSpec sensor = *load_sensor("sc2000");

  const auto found = dynamic_acuity(sensor, observer, options);
  TemplateObserver blind(TemplateObserverSpec{}, triangle_alternatives());
  const auto without = dynamic_acuity(sensor, blind, options);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->notes, ::testing::IsEmpty());
  expect_spreads(found->speeds);
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_FALSE(without->speeds.front().points.front().s75_spread_mrad);
}

TEST(MovingMeasurement, FollowsTheLineOfTheStageWhereItIsAskedTo) {
  const auto plan = small_plan("16.9", 2,
                               "[motion]\nspeeds_mrad_s = [40]\npasses = 2\nframes = 3\nlead_frames = 1\nplaces = "
                               "\"stage\"\n");

  const auto found = measure_dynamic(plan, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->time_constant.has_value()) << "two passes do not make an interval";
  for (const MovingPassRecord& pass : found->measured.passes) {
    EXPECT_EQ(pass.dropped, "");
    if (pass.speed_mrad_s == 0) continue;
    EXPECT_NEAR(pass.measured_px_s / pass.said_px_s, 1, 0.01);
    EXPECT_NEAR(pass.said_px_s, 40 / plan.sensor().ifov_mrad(), 0.1);
    EXPECT_NEAR(*pass.lag_s, 0, 1e-3);
  }
}

TEST(TimeConstant, FromReversedMotionIsTheLagWithoutTheOffset) {
  std::vector<MovingPassRecord> passes;
  const RandomStream noise(4, "lag");
  for (int i = 0; i < 40; ++i) {
    MovingPassRecord pass;
    pass.along_x = i % 2 == 0 ? 1 : -1;
    pass.said_px_s = i % 4 < 2 ? 10 : 40;
    const double place_px =
        0.3 * pass.along_x + 0.02 * static_cast<double>(noise.normal(static_cast<std::uint64_t>(i)));
    pass.lag_s = 0.012 + 0.003 / 2 + place_px / pass.said_px_s;
    passes.push_back(pass);
  }

  const auto found = time_constant_of(passes, 3);

  ASSERT_TRUE(found.has_value());
  // Of 40 places with 0.02 px at 10 and 40 px/s: 0.02 / sqrt(40 x 850) s = 0.11 ms.
  EXPECT_NEAR(found->time_constant_ms, 12, 4 * 0.11);
  EXPECT_NEAR(*found->ci95_ms.high - *found->ci95_ms.low, 4 * 0.11, 0.2);
  EXPECT_NEAR(found->offset_px, 0.3, 0.02);
  for (auto& pass : passes) pass.along_x = 1;
  EXPECT_FALSE(time_constant_of(passes, 3)) << "one direction does not tell lag from offset";
  for (auto& pass : passes) pass.lag_s.reset();
  EXPECT_FALSE(time_constant_of(passes, 3)) << "no trigger";
}

}  // namespace
}  // namespace todbench
