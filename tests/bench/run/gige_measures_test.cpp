// SPDX-License-Identifier: GPL-3.0-or-later
// Response time and drift of the emulated GigE camera, which has them as it is told, through the GigE path.
#include <gmock/gmock.h>

#include <cmath>
#include <string>

#include "bench/devices/emulation.h"
#include "bench/plan/descriptions.h"
#include "sim_devices/prediction/virtual_mrtd.h"
#include "tests/bench/run/emulated_measures.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"
#include "tod/camera_measures/camera_measures.h"

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

TEST(GigeMeasures, FindTheResponseTimeOfTheEmulatedCamera) {
  const testing::TemporaryFolder folder;
  Plan plan = wire_plan();
  const std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  plan.simulation.sensor = folder.write("bolometer.toml", text + "\ntime_constant_ms = 15\nexposure_ms = 3\n").string();
  EmulationArguments arguments = emulation_for(plan);
  arguments.black_body_time_constant_s = 1e-4;
  CameraMeasuresOptions options;
  options.response = ResponseOptions{.plate = {}, .steps = 8, .frames = 12, .settling_s = 0.001};

  const auto measures = testing::measured(plan, arguments, options);

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(measures->response);
  const StepTimeConstant& found = measures->response->response.both;
  // Two half-widths are four standard uncertainties.
  EXPECT_NEAR(found.value_s, 0.015, found.high_s - found.low_s);
  EXPECT_LT(found.high_s - found.low_s, 0.4 * 0.015);
}

TEST(GigeMeasures, FindTheMrtdThatTheSensorHasWithoutFrames) {
  Plan plan = wire_plan();
  plan.measures.mrtd = true;  // the stage has the plate
  CameraMeasuresOptions options;
  options.mrtd = MrtdOptions{.plate = *load_plate("mrtd"),
                             .contrasts_k = {0.008, 0.016, 0.032, 0.064},
                             .frames = 12,
                             .set_ups = 5,
                             .frequency_per_pitch = 0.3};
  VirtualMrtdTask task;
  task.sensor = *load_sensor(plan.simulation.sensor);
  task.plan = full_plan(task.sensor, {}, {});
  task.accuracy = Accuracy::draft();
  task.draws = 600;
  task.frequencies_per_mrad = {0.3 / task.sensor.ifov_mrad()};

  const auto measures = testing::measured(plan, emulation_for(plan), options);
  const auto virtual_bars = virtual_mrtd(task);

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(measures->mrtd && virtual_bars);
  for (const EdgeAxis axis : {EdgeAxis::x, EdgeAxis::y}) {
    const MrtdPoint* point = measures->mrtd->stated(axis);
    ASSERT_TRUE(point != nullptr && point->threshold_k && point->ci95.low && point->ci95.high);
    // Two half-widths are four standard uncertainties, of both.
    const double apart = std::log(*point->threshold_k / *virtual_bars->front().threshold_k);
    const double half = 0.5 * std::log(*point->ci95.high / *point->ci95.low);
    EXPECT_LT(std::abs(apart), 2 * std::hypot(half, 1.96 * virtual_bars->front().relative_error));
    EXPECT_LT(half, 0.6);
  }
}

TEST(GigeMeasures, RefuseAResponseTimeThatTheBlackBodyCovers) {
  Plan plan = wire_plan();
  CameraMeasuresOptions options;
  options.response = ResponseOptions{.plate = {}, .steps = 4, .frames = 12, .settling_s = 0.3};

  const auto measures = testing::measured(plan, emulation_for(plan), options);

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_FALSE(measures->response);
  ASSERT_EQ(measures->reasons.size(), 1u);
}

TEST(GigeMeasures, FindTheDriftThatTheEmulatedCameraIsTold) {
  Plan plan = wire_plan();
  plan.camera.nuc_interval_s = 100, plan.camera.nuc_wait_s = 0.2;
  EmulationArguments arguments = emulation_for(plan);
  arguments.drift_k_per_min = 1.2, arguments.drift_pattern_k_per_min = 0.6;
  CameraMeasuresOptions options;
  options.drift_s = 3;

  const auto measures = testing::measured(plan, arguments, options);

  ASSERT_TRUE(measures) << measures.error().message;
  EXPECT_THAT(measures->reasons, ::testing::IsEmpty());
  ASSERT_TRUE(measures->drift);
  const DriftLaw& law = measures->drift->law;
  // Two half-widths are four standard uncertainties.
  const auto off = [&](const DriftFit& fit, double k_per_min) {
    const double half = 0.5 * (fit.change_ci95.high.value() - fit.change_ci95.low.value());
    return std::abs(fit.change_k - k_per_min / law.per_minute(1)) / half;
  };
  EXPECT_LT(off(law.level, arguments.drift_k_per_min), 2);
  EXPECT_LT(off(law.pattern, arguments.drift_pattern_k_per_min), 2);
  EXPECT_GT(law.level.change_ci95.low.value(), 0);
  EXPECT_GT(law.pattern.change_ci95.low.value(), 0);
}

}  // namespace
}  // namespace todbench
