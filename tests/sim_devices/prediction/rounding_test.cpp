// SPDX-License-Identifier: GPL-3.0-or-later
// The estimate without frames where counts are coarse or end: against trials on frames of the camera.
#include <gmock/gmock.h>

#include "sim_devices/prediction/effect_planner.h"
#include "sim_devices/sensor/effect_quantisation.h"
#include "tests/sim_devices/prediction/brute_force.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;

TEST(CoarseRounding, GivesTheThresholdOfTrials) {
  TemplateObserver observer({}, triangle_alternatives());
  for (const auto& rounded : {test::RoundedCase{0.05, 1.5}, test::RoundedCase{0.3, 0.6}, test::RoundedCase{1.2, 5}})
    test::expect_estimate_is_what_trials_say(rounded, observer, 2);
}

TEST(CoarseRounding, IsToldFromNoise) {
  EXPECT_TRUE(rounds_coarsely(test::rounded_sensor(0.05)));
  EXPECT_TRUE(rounds_coarsely(test::rounded_sensor(0.95)));
  EXPECT_FALSE(rounds_coarsely(test::rounded_sensor(1.05)));
  SensorSpec spec = test::rounded_sensor(3);
  spec.frames_averaged = 16;  // 0.75 counts are left
  EXPECT_TRUE(rounds_coarsely(spec));
  spec.noise_correlation = 0.9;  // averaging helps little
  EXPECT_FALSE(rounds_coarsely(spec));
}

TEST(CoarseRounding, LeavesThePlannerWithoutACriterion) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec spec = test::rounded_sensor(0.3);

  const auto plan = plan_effects(spec, observer, {.delta_t_k = {0.6}, .motion = {}},
                                 {.tolerance_percent = 50, .skip = {}, .force = {}});

  ASSERT_TRUE(plan) << plan.error().message;
  for (const auto& decision : plan->plan.decisions) {
    EXPECT_EQ(decision.decision == Decision::skip, is_neutral(spec, decision.effect)) << to_string(decision.effect);
    if (decision.decision == Decision::simulate) {
      EXPECT_THAT(decision.reason, HasSubstr("0.3 counts"));
    }
  }
}

TEST(CoarseRounding, ThatHidesTheContrastIsSaid) {
  TemplateObserver observer({}, triangle_alternatives());
  const SensorSpec spec = test::rounded_sensor(0.01);

  const auto points = direct_estimate(spec, full_plan(spec, {}, {}), observer, {0.03}, {.accuracy = Accuracy::draft()});

  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("disappears in the rounding to counts of 0.1 K"));
}

TEST(CoarseRounding, SaysWhereTheCountsEndBeforeTheScene) {
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec spec = test::sc2000();
  spec.kelvin_per_count = 0.003;
  spec.offset_k = spec.scene_temperature_k - 0.003 * 16384;

  const auto points = direct_estimate(spec, full_plan(spec, {}, {}), observer, {2}, {.accuracy = Accuracy::draft()});

  ASSERT_FALSE(points);
  EXPECT_THAT(points.error().message, HasSubstr("outside the range of the counts"));
}

TEST(CoarseRounding, KnowsTheReadingOfACountsMiddleAndEdge) {
  SensorSpec spec = test::rounded_sensor(0);
  const Quantiser quantiser(spec, spec.scene_temperature_k);
  const auto reading = [&](double counts, double sd) { return quantiser.reading(0.1 * counts, 0.1 * sd); };

  EXPECT_NEAR(reading(0, 0.05).mean_k, 0, 1e-12);
  EXPECT_NEAR(reading(0, 0.05).sd_k, 0, 1e-9);
  EXPECT_NEAR(reading(0.5, 0.05).mean_k, 0.05, 1e-12);
  EXPECT_NEAR(reading(0.5, 0.05).sd_k, 0.05, 1e-12);
  // White noise of 30 counts: Sheppard's correction.
  EXPECT_NEAR(reading(0.3, 30).mean_k, 0.03, 1e-9);
  EXPECT_NEAR(reading(0.3, 30).sd_k, 0.1 * std::sqrt(900 + 1.0 / 12), 1e-6);
}

TEST(ClippedTarget, IsEstimatedAsTheCameraShowsIt) {
  TemplateObserver observer({}, triangle_alternatives());
  SensorSpec spec = test::sc2000();
  for (const double scene_k : {300.0, -300.0}) {
    const double seen_k = scene_k > 0 ? 113.83 : -50;  // 250 to 413.83 K, surround at 300 K

    const auto direct = direct_estimate(spec, full_plan(spec, {}, {}), observer, {scene_k},
                                        {.accuracy = Accuracy::normal(), .seed = 3});

    ASSERT_TRUE(direct) << direct.error().message;
    EXPECT_NEAR(direct->front().seen_delta_t_k, seen_k, 0.05);
    const test::ThresholdByTrials trials = test::threshold_by_trials(spec, observer, direct->front(), scene_k, 2, 17);
    const double error = std::hypot(direct->front().standard_error_pitch, trials.standard_error_pitch);
    EXPECT_NEAR(direct->front().s75_pitch, trials.s75_pitch, 0.01 * trials.s75_pitch + 3 * error) << scene_k;
  }
}

}  // namespace
}  // namespace todbench
