// What a plan says of graded answers before it is measured.
#include "bench/run/graded_precision.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/run/precision_frontier.h"

namespace todbench {
namespace {

TEST(GradedPrecision, IsThatOfFramesAloneWhereTheSensorMakesAllTheNoise) {
  // f = (9/16) (2/3 - 4/9) / (3/16) = 2/3.
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 1, .frames = 1}), 2.0 / 3 + (1 - 2.0 / 3) / 32 + 0.004, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 1, .frames = 4}), (2.0 / 3 + 1.0 / 96) / 4 + 0.004, 1e-12);
}

TEST(GradedPrecision, IsThatOfDrawsWhereTheObserverMakesAllTheNoise) {
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 0, .frames = 4}), 1.0 / 128 + 0.004, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 0, .frames = 4, .set_ups = 4}), 1.0 / 128 + 0.15, 1e-12);
}

TEST(GradedPrecision, IsWiderForFewSetUps) {
  // t of seven degrees of freedom, and chi square of seven at 95 %.
  EXPECT_NEAR(graded_interval_factor({.set_ups = 8}), 2.3646 * std::sqrt(14.067 / 7), 1e-3);
  EXPECT_GT(graded_interval_factor({.set_ups = 5}), graded_interval_factor({.set_ups = 16}));
}

TEST(PrecisionFrontier, HasEveryChoiceAndRecommendsOne) {
  Plan plan;
  plan.target.phases = plan.simulation.phases = 4;
  plan.simulation.accuracy = "draft";
  plan.schedule.answers = AnswerKind::graded;
  plan.schedule.frames_per_presentation = 3;
  plan.fit.estimator = EstimatorChoice::twin_shape;
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner);
  ASSERT_TRUE(inputs);

  const auto choices = precision_frontier(plan, *inputs, {});

  ASSERT_TRUE(choices) << choices.error().message;
  ASSERT_EQ(choices->size(), 6u) << "binary, 1, 2, 3, 4, 8";
  EXPECT_EQ(choices->front().answers, AnswerKind::binary);
  int planned = 0, recommended = 0;
  for (std::size_t i = 0; i < choices->size(); ++i) {
    const PrecisionChoice& choice = (*choices)[i];
    planned += choice.planned ? 1 : 0;
    recommended += choice.recommended ? 1 : 0;
    ASSERT_TRUE(choice.half_width_percent);
    if (i > 1) {
      EXPECT_LT(*choice.half_width_percent, *(*choices)[i - 1].half_width_percent);
      EXPECT_GE(choice.seconds, (*choices)[i - 1].seconds);
    }
  }
  EXPECT_EQ(planned, 1);
  EXPECT_TRUE((*choices)[3].planned);
  EXPECT_EQ(recommended, 1);
  EXPECT_LT(*(*choices)[4].half_width_percent, *(*choices)[0].half_width_percent);
  const Json json = frontier_json(*choices);
  EXPECT_EQ(json.size(), 6u);
  EXPECT_EQ(json[4]["frames_per_presentation"], 4);
}

}  // namespace
}  // namespace todbench
