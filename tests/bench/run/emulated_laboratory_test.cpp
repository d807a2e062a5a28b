// SPDX-License-Identifier: GPL-3.0-or-later
// Absolute temperatures, collimator, latency and times of frames of the emulated laboratory, over its real protocols.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <string>

#include "bench/plan/collimator.h"
#include "bench/plan/descriptions.h"
#include "tests/bench/run/emulated_measures.h"

namespace todbench {
namespace {

Plan wire_plan() {
  Plan plan = *load_plan("demo");
  plan.fit.estimator = EstimatorChoice::weibull;  // not of the function of the twin, which takes longer than the rest
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9};
  plan.simulation.accuracy = "draft";
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 8;
  plan.measurement.frame_timeout_ms = 20000;
  plan.measurement.max_rejected_share = 0.9;  // a busy machine loses frames, and the others say the same
  plan.limits = {};
  return plan;
}

AbsoluteOptions absolute_options() {
  return {.plate = "open", .temperatures_k = {285, 295, 305}, .frames = 8, .shift_px = 0, .pixel_mm = 2.617};
}

EmulationArguments with_open_plate(const Plan& plan) {
  EmulationArguments arguments = emulation_for(plan);
  arguments.plates.emplace_back("open");
  return arguments;
}

TEST(EmulatedLaboratory, ShowsAbsoluteTemperatures) {
  const Plan plan = wire_plan();
  CameraMeasuresOptions options;
  options.absolute = absolute_options();

  const auto measures = testing::measured(plan, with_open_plate(plan), options);

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(measures->absolute);
  const AbsoluteMeasure& found = *measures->absolute;
  for (const AbsoluteLevel& level : found.levels) {
    std::printf("%.3f K: read %.4f, seen %.4f\n", level.set_k, level.said_k, level.seen_k);
    // The black body is within 2 mK of its set-point; the camera rounds to 10 mK, with noise of several counts.
    EXPECT_NEAR(level.said_k, level.set_k, 0.003);
    EXPECT_NEAR(level.seen_k, level.said_k, 0.01);
  }
  EXPECT_NEAR(found.slope.value, 1, 0.001);
}

TEST(EmulatedLaboratory, IsSeenThroughItsCollimator) {
  Plan plan = wire_plan();
  plan.target.collimator = {.focal_length_mm = 2000, .transmission = 0.8, .mirror_temperature_c = 30};
  plan.target.distance_m = 2;
  CameraMeasuresOptions options;
  options.absolute = absolute_options();
  options.absolute->expected_k = [plan](double black_body_k) { return seen_through_k(plan, {7.5, 13}, black_body_k); };
  EmulationArguments arguments = with_open_plate(plan);

  const auto right = testing::measured(plan, arguments, options);
  arguments.collimator_transmission = 0.7;
  const auto wrong = testing::measured(plan, arguments, options);

  ASSERT_TRUE(right && right->absolute);
  for (const AbsoluteLevel& level : right->absolute->levels) EXPECT_NEAR(level.seen_k, level.expected_k, 0.012);
  // A wrong transmission shows in the slope: 0.7 / 0.8, up to the curvature of Planck's law.
  ASSERT_TRUE(wrong && wrong->absolute);
  EXPECT_NEAR(right->absolute->slope.value, 1, 0.001);
  EXPECT_NEAR(wrong->absolute->slope.value, 0.875, 0.01);
}

TEST(EmulatedLaboratory, RefusesABlackBodyThatAnswersInDegreesCelsius) {
  Plan plan = wire_plan();
  plan.measures.absolute = true;
  plan.target.kind = TargetKind::scpi;
  EmulationArguments arguments = emulation_for(plan);
  arguments.celsius = true;
  auto laboratory = start_laboratory(arguments);
  ASSERT_TRUE(laboratory) << laboratory.error().message;
  const auto loaded = LoadedPlan::load(with_laboratory(plan, **laboratory));
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto bench = open_bench(*loaded, {});

  ASSERT_FALSE(bench);
  EXPECT_EQ(bench.error().code, ErrorCode::invalid_input);
  EXPECT_THAT(bench.error().message, ::testing::HasSubstr("degrees Celsius"));
}

TEST(EmulatedLaboratory, TellsItsLatencyAndTheTimesOfItsFrames) {
  const Plan plan = wire_plan();
  CameraMeasuresOptions options;
  options.timing_frames = 30;
  options.latency = LatencyOptions{.speed_mm_s = 60, .travel_mm = 30, .runs = 2};
  EmulationArguments arguments = emulation_for(plan);
  arguments.latency_ms = 0;
  const auto prompt = testing::measured(plan, arguments, options);
  arguments.latency_ms = 35;

  const auto late = testing::measured(plan, arguments, options);

  ASSERT_TRUE(prompt) << prompt.error().message;
  ASSERT_TRUE(late) << late.error().message;
  EXPECT_THAT(late->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(prompt->latency && late->latency && late->timing);
  std::printf("latency: %.3f ms without, %.3f ms with a delay of 35 ms\n", prompt->latency->latency_ms.value,
              late->latency->latency_ms.value);
  // 60 mm/s are 0.46 pixels a frame; a place is known to about 0.02 pixels, 0.9 ms, in each of several dozen frames.
  EXPECT_NEAR(late->latency->latency_ms.value - prompt->latency->latency_ms.value, 35, 2);
  EXPECT_NEAR(late->timing->rate_hz.value, 50, 0.5);
}

}  // namespace
}  // namespace todbench
