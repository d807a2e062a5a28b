// SPDX-License-Identifier: GPL-3.0-or-later
// How often a hot bar before a linear camera is found to change nothing.
#include <gtest/gtest.h>

#include <iostream>

#include "bench/plan/plan.h"
#include "bench/scene_dependence/scene_dependence.h"

namespace todbench {
namespace {

TEST(SceneDependenceStudy, OfALinearCameraHoldsOneInAllIntervalsTogether) {
  constexpr int seeds = 100;
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.schedule.frames_per_presentation = {8};
  plan.target.delta_t_k = {16.9};
  plan.simulation.accuracy = "draft";
  plan.limits = {};
  int held = 0, independent = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    plan.seed = static_cast<std::uint64_t>(seed);
    const auto loaded = LoadedPlan::load(plan);
    ASSERT_TRUE(loaded) << loaded.error().message;
    const auto found = plan_scene_dependence(*loaded, nullptr, 40, {.cycles = 6, .frames = 4}, {}, {});
    ASSERT_TRUE(found) << found.error().message;
    bool all = true;
    for (const SizeDependence& size : found->sizes) all = all && *size.ci95.low <= 1 && 1 <= *size.ci95.high;
    held += all ? 1 : 0;
    independent += found->verdict == SceneDependenceVerdict::independent ? 1 : 0;
  }
  std::cout << "held in " << held << " of " << seeds << " seeds, independent in " << independent << "\n";
  EXPECT_GE(held, 89) << "95 % less three standard deviations of 2.2";
  EXPECT_EQ(independent, seeds);
}

}  // namespace
}  // namespace todbench
