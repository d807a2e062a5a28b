// SPDX-License-Identifier: GPL-3.0-or-later
// Dynamic TOD on the emulated GigE camera, its stage on SCPI.
#include <gmock/gmock.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "bench/devices/emulation.h"
#include "bench/moving_target/dynamic_measurement.h"
#include "tests/support/source_file.h"
#include "tests/support/temporary_folder.h"

namespace todbench {
namespace {

Plan moving_plan(const testing::TemporaryFolder& folder) {
  Plan plan = *load_plan("demo");
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9};
  plan.simulation.accuracy = "draft";
  const std::string text = testing::content_of(source_file("sim_devices/sensors/sc2000.toml"));
  plan.simulation.sensor = folder.write("bolometer.toml", text + "\ntime_constant_ms = 10\n").string();
  plan.measurement.registration_frames = 4;
  plan.measurement.contrast_frames = 4;
  plan.measurement.frame_timeout_ms = 20000;
  plan.measurement.max_rejected_share = 0.9;  // a busy machine loses frames, and the others say the same
  plan.limits = {};
  plan.motion = {.speeds_mrad_s = {35}, .passes = 4, .frames = 3, .lead_frames = 1};
  return plan;
}

TEST(MovingCamera, HasItsTimeConstantFoundThroughTheGigePath) {
  const testing::TemporaryFolder folder;
  const Plan plan = moving_plan(folder);
  auto laboratory = start_laboratory(emulation_for(plan));
  ASSERT_TRUE(laboratory) << laboratory.error().message;
  const auto loaded = LoadedPlan::load(with_laboratory(plan, **laboratory));
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = measure_dynamic(*loaded, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  for (const MovingPassRecord& pass : found->measured.passes) EXPECT_EQ(pass.dropped, "") << pass.pass;
  ASSERT_TRUE(found->time_constant.has_value());
  EXPECT_NEAR(found->time_constant->time_constant_ms, 10, 0.5) << "5 %";
  EXPECT_EQ(found->contrasts.at(0).speeds.size(), 2u);
  EXPECT_LT(found->residual_px, 0.05);
}

TEST(MovingCamera, OfAStageWithoutTriggerHasPlacesButNoTimeConstant) {
  const testing::TemporaryFolder folder;
  const Plan plan = moving_plan(folder);
  EmulationArguments arguments = emulation_for(plan);
  arguments.trigger = false;
  arguments.stage_jitter_mm = 0.26;  // 0.1 pixels at 2 m
  auto laboratory = start_laboratory(arguments);
  ASSERT_TRUE(laboratory) << laboratory.error().message;
  const auto loaded = LoadedPlan::load(with_laboratory(plan, **laboratory));
  ASSERT_TRUE(loaded) << loaded.error().message;

  const auto found = measure_dynamic(*loaded, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->time_constant.has_value());
  // 0.1 px along one of two axes, three places on a line whose middle is theirs: 0.1 sqrt(2 / 3 / 2) = 0.058 px, of two
  // free numbers in each pass with answers. The jitter follows the clock; each limit fails one run in 100,000.
  const auto& passes = found->measured.passes;
  const auto moved = std::ranges::count_if(
      passes, [](const MovingPassRecord& pass) { return pass.speed_mrad_s > 0 && pass.dropped.empty(); });
  ASSERT_GE(moved, 2) << "of four";
  const boost::math::chi_squared squares(2.0 * static_cast<double>(moved));
  const double expected_px = 0.1 / std::sqrt(3.0);
  EXPECT_GT(found->residual_px, expected_px * std::sqrt(quantile(squares, 1e-5) / squares.degrees_of_freedom()));
  EXPECT_LT(found->residual_px,
            expected_px * std::sqrt(quantile(complement(squares, 1e-5)) / squares.degrees_of_freedom()));
}

}  // namespace
}  // namespace todbench
