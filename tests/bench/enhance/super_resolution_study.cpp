// SPDX-License-Identifier: GPL-3.0-or-later
// Super-resolution by measured shifts beside that by known ones and the direct estimate.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/plan.h"
#include "sim_devices/prediction/direct_estimate.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/plate/test_pattern.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

EnhancementPackage finer_by(FrameShifts shifts) {
  EnhancementPackage package;
  package.name = shifts == FrameShifts::scan ? "scan" : "measured";
  package.stages = {
      {.kind = StagePlan::Kind::super_resolution, .super_resolution = {.frames = 4, .factor = 2, .shifts = shifts}}};
  return package;
}

/// Eight presentations of twenty triangles.
LoadedPlan eight_presentations(double contrast_k, int seed) {
  Plan plan = *load_plan("demo");
  plan.camera = {};
  plan.target.kind = TargetKind::scene;
  plan.target.plates = {"tcat-a"};
  plan.target.mountings = {Mounting::identity};
  plan.target.distance_m = 2.5;  // the smallest triangles are below the threshold
  plan.target.delta_t_k = {contrast_k};
  plan.schedule.frames_per_presentation = {8};
  plan.simulation.accuracy = "draft";
  plan.simulation.phases = 8;
  plan.measurement.registration_frames = 8;
  plan.measurement.contrast_frames = 4;
  plan.limits = {};
  plan.seed = static_cast<std::uint64_t>(seed);
  return LoadedPlan::load(plan).value();
}

TEST(SuperResolutionStudy, ByMeasuredShiftsIsThatOfFinerSampling) {
  constexpr int seeds = 6;
  constexpr double contrast_k = 16.9;
  std::vector<Trial> scan, measured;
  for (int seed = 1; seed <= seeds; ++seed) {
    const LoadedPlan plan = eight_presentations(contrast_k, seed);
    const auto found =
        compare_packages(plan, {finer_by(FrameShifts::scan), finer_by(FrameShifts::measured)}, {.dither = 2}, {});
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t i = 1; i < 3; ++i) {
      ASSERT_FALSE(found->results[i].error) << found->results[i].error->message;
      for (Trial trial : found->results[i].trials) {
        trial.presentation += 8 * (seed - 1);
        trial.delta_t_k = contrast_k;  // each has its own estimate of it
        (i == 1 ? scan : measured).push_back(trial);
      }
    }
  }
  const LoadedPlan plan = eight_presentations(contrast_k, 1);
  SensorSpec fine = plan.sensor();
  fine.super_resolution_frames = 4;
  TemplateObserver observer(plan.observer(), triangle_alternatives());
  const auto direct = direct_estimate(fine, full_plan(fine, {}, {}), observer, {contrast_k},
                                      {.accuracy = Accuracy::normal(), .seed = 1});
  ASSERT_TRUE(direct) << direct.error().message;
  const double expected_mrad = direct->front().s75_pitch * fine.ifov_mrad();
  std::size_t same = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) same += scan[i].answer == measured[i].answer ? 1 : 0;
  std::printf("%zu of %zu answers by measured shifts are those by known ones; direct S75 %.3f mrad\n", same,
              scan.size(), expected_mrad);
  // A wrong shift of a quarter of a pixel would put a frame into another cell.
  EXPECT_GE(same, scan.size() * 99 / 100);
  for (const auto* trials : {&scan, &measured}) {
    const auto curve = tod_curve(*trials, FitOptions{});
    ASSERT_TRUE(curve) << curve.error().message;
    const PsychometricFit& fit = curve->points.front().fit;
    ASSERT_TRUE(fit.ci95.low && fit.ci95.high) << to_string(fit.verdict);
    std::printf("%s: S75 %.3f mrad, 95 %% %.3f to %.3f\n", trials == &scan ? "known shifts" : "measured shifts",
                fit.threshold.value_or(0), *fit.ci95.low, *fit.ci95.high);
    EXPECT_LE(*fit.ci95.low, expected_mrad) << to_string(fit.verdict);
    EXPECT_GE(*fit.ci95.high, expected_mrad);
  }
}

}  // namespace
}  // namespace todbench
