// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan says of graded answers before it is measured.
#include "bench/forecast/graded_precision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/twin/twin_shapes.h"

namespace todbench {
namespace {

TEST(GradedPrecision, IsThatOfFramesAloneWhereTheSensorMakesAllTheNoise) {
  // f = (9/16) (2/3 - 4/9) / (3/16) = 2/3.
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 1, .frames = 1}), 2.0 / 3 + (1 - 2.0 / 3) / 32 + 0.004, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 1, .frames = 4}), (2.0 / 3 + 1.0 / 96) / 4 + 0.004, 1e-12);
}

TEST(GradedPrecision, IsThatOfDrawsWhereTheObserverMakesAllTheNoise) {
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 0, .frames = 4}), 1.0 / 128 + 0.004, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 0, .frames = 4, .set_ups = 4}), 1.0 / 128 + 0.28, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.sensor_share = 0, .noise = 0.26, .frames = 4, .set_ups = 4}),
              1.0 / 128 + 0.28 / 5, 1e-12)
      << "noise hides the phases";
}

TEST(GradedPrecision, KeepsMoreOfFewPhases) {
  const double of_noise = 1.0 / 128;
  EXPECT_NEAR(graded_variance_ratio({.frames = 4, .presentations = 24}), of_noise + 0.016, 1e-12) << "three phases";
  EXPECT_NEAR(graded_variance_ratio({.frames = 4, .presentations = 128}), of_noise + 0.003, 1e-12);
  EXPECT_NEAR(graded_variance_ratio({.frames = 4, .presentations = 8}), of_noise + 0.048, 1e-12);
}

TEST(GradedPrecision, OfUnequalSetUpsKeepsThePhasesInItsInterval) {
  // Five set-ups whose shares of the information count as 4.8: presentations and places are the clusters.
  const GradedDesignFigures unequal{.frames = 4,
                                    .set_ups = 5,
                                    .informative_set_ups = 4.8,
                                    .presentations = 30,
                                    .informative_presentations = 28.8,
                                    .informative_places = 10.7};
  EXPECT_NEAR(graded_variance_ratio(unequal), 1.0 / 128 + 0.28, 1e-12);
  EXPECT_NEAR(graded_freedom(unequal), 9.7, 1e-12) << "places";
  GradedDesignFigures many_places = unequal;
  many_places.informative_places = 40;
  EXPECT_NEAR(graded_freedom(many_places), 27.8, 1e-12) << "presentations";
  GradedDesignFigures equal = unequal;
  equal.informative_set_ups = 5;
  EXPECT_NEAR(graded_variance_ratio(equal), 1.0 / 128 + 0.048 / 6, 1e-12);
  EXPECT_NEAR(graded_freedom(equal), 4, 1e-12);
}

TEST(GradedPrecision, KeepsAFixedPatternWhateverTheFrames) {
  // All noise is a fixed pattern: two thirds of an answer, in 12 phases that see the same one, and nothing else.
  const double alike = 12 * 1.5 * std::exp(-std::pow(1.9 / 4, 2));
  const GradedDesignFigures pattern{.sensor_share = 1, .pattern_share = 1, .frames = 1};
  EXPECT_NEAR(graded_variance_ratio(pattern), (1 - 2.0 / 3) / 32 + 0.004 + 2.0 / 3 * alike, 1e-12);
  EXPECT_NEAR(pattern_inflation(pattern), 1 + 2.0 / 3 * (alike - 1), 1e-12);
  EXPECT_DOUBLE_EQ(pattern_inflation({.sensor_share = 1}), 1);
  GradedDesignFigures small = pattern;
  small.size_pitch = 1;
  EXPECT_NEAR(pattern_inflation(small), 1, 1e-12) << "a pixel beside it a small triangle sees other detectors";
  const auto gain = [](GradedDesignFigures design) {
    const double one = graded_variance_ratio(design);
    design.frames = 8;
    return one / graded_variance_ratio(design);
  };
  EXPECT_GT(gain({.sensor_share = 1}), 7);
  EXPECT_LT(gain({.sensor_share = 1, .pattern_share = 0.5}), 1.2);
}

TEST(GradedPrecision, FramesOfNoiseThatIsCorrelatedInTimeTellLess) {
  const GradedDesignFigures white{.sensor_share = 1, .frames = 8};
  GradedDesignFigures constant = white;
  constant.noise_correlation = 1;
  // Without decay the frames and the 12 presentations of a set-up all see one noise: 2/3 of an answer, as a pattern.
  const double alike = std::exp(-std::pow(1.9 / 4, 2));
  EXPECT_NEAR(graded_variance_ratio(constant), 2.0 / 3 * (1 + 11 * alike) + (1 - 2.0 / 3) / 256 + 0.004, 1e-9);
  GradedDesignFigures apart = constant;
  apart.noise_correlation = 0.8;
  apart.frames_between = 1000;
  EXPECT_GT(graded_variance_ratio(apart), 2 * graded_variance_ratio(white));
  EXPECT_LT(graded_variance_ratio(apart), graded_variance_ratio({.sensor_share = 1, .frames = 1}));
  GradedDesignFigures close = apart;
  close.frames_between = 0;
  EXPECT_GT(graded_variance_ratio(close), graded_variance_ratio(apart));
  EXPECT_GT(pattern_inflation(close), 1.1);
  EXPECT_NEAR(pattern_inflation(apart), 1, 1e-9);
}

TEST(GradedPrecision, IsWiderForFewSetUps) {
  // t of seven degrees of freedom, and chi square of seven at 95 %.
  EXPECT_NEAR(graded_interval_factor({.set_ups = 8}), 1.06 * 2.3646 * std::sqrt(14.067 / 7), 1e-3);
  EXPECT_GT(graded_interval_factor({.set_ups = 5}), graded_interval_factor({.set_ups = 16}));
}

TEST(GradedPrecision, FramesAreTheFewestNearTheLeastVarianceTimesTime) {
  const GradedDesignFigures all_sensor{.sensor_share = 1}, all_observer{.sensor_share = 0};
  // Variance times time with 1, 2, 4, 8: (2/3 + 1/96) / F + 0.004, and 1 / (32 F) + 0.004.
  EXPECT_EQ(cheapest_frames(all_sensor, 1, 1), 1) << "0.681, 0.685, 0.693, ...: a frame costs as much as all else";
  EXPECT_EQ(cheapest_frames(all_sensor, 1, 0.1), 8);
  EXPECT_EQ(cheapest_frames(all_observer, 1, 0.2), 4) << "0.0353, 0.0236, 0.0189, 0.0190";
  EXPECT_EQ(cheapest_frames(all_observer, 1, 0), 8);
}

TEST(WithFrames, ChoosesWhatThePlanLeavesOpenAndNothingElse) {
  Plan plan;
  plan.simulation.accuracy = "draft";
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
  const auto frames = [&] { return with_frames(plan, inputs).schedule.frames_per_presentation; };
  EXPECT_EQ(frames(), std::vector<int>{4}) << "a simulated scene takes no time on a bench";
  plan.target.kind = TargetKind::scpi;
  EXPECT_EQ(frames(), std::vector<int>{8});
  plan.target.plate_change_s = plan.target.mounting_change_s = plan.target.contrast_change_s =
      plan.target.shift_change_s = 0;
  plan.measurement.registration_frames = plan.measurement.contrast_frames = 1;
  const std::vector<int> quick = frames();
  ASSERT_EQ(quick.size(), 3U);
  EXPECT_LT(quick[0], quick[2]) << "phases limit at a high contrast, noise at a low one";
  plan.schedule.frames_per_presentation = {0, 5, 0};
  EXPECT_EQ(frames(), (std::vector<int>{quick[0], 5, quick[2]}));
  plan.schedule.answers = AnswersChoice::binary;
  EXPECT_EQ(frames(), std::vector<int>{1});
}

/// Six presentations of five sizes, graded: the larger the more probable, and mostly right.
std::vector<Trial> graded_trials() {
  std::vector<Trial> trials;
  for (int i = 0; i < 120; ++i) {
    Trial trial;
    trial.presentation = i / 20;
    trial.triangle = std::to_string(i % 20);
    trial.set_delta_t_k = trial.delta_t_k = 2;
    trial.size_mrad = 1 + i % 5;
    trial.probability_correct = 0.3 + 0.14 * (i % 5);
    trial.frames = 4;
    trial.truth = Apex::up;
    trial.answer = (7 * i) % 10 < 3 + 1.4 * (i % 5) ? Apex::up : Apex::left;
    trials.push_back(trial);
  }
  return trials;
}

TEST(GradedAnswers, WithoutAFunctionOfTheTwinAreFittedAsRightAndWrongOnes) {
  const std::vector<Trial> trials = graded_trials();
  auto curve = tod_curve(trials, {});
  const auto binary = tod_curve(as_binary(trials), {});
  ASSERT_TRUE(curve && binary);
  ASSERT_TRUE(is_quasi(curve->points[0].fit.interval));

  fit_right_and_wrong(*curve, trials, {});

  const TodPoint &point = curve->points[0], &expected = binary->points[0];
  EXPECT_FALSE(is_quasi(point.fit.interval));
  EXPECT_EQ(point.fit.threshold, expected.fit.threshold);
  EXPECT_EQ(point.fit.ci95.low, expected.fit.ci95.low);
  EXPECT_EQ(point.levels.size(), expected.levels.size());
  EXPECT_EQ(point.answers, (AnswersTaken{AnswerKind::binary, 1, AnswersReason::no_function}));
}

TEST(GradedAnswers, KeepTheFunctionOfTheTwinWhereTheyHaveIt) {
  const std::vector<Trial> trials = graded_trials();
  auto curve = tod_curve(trials, {});
  ASSERT_TRUE(curve);
  curve->points[0].fit.twin_shape = TwinShapeUse{};
  const auto before = curve->points[0].fit.threshold;

  fit_right_and_wrong(*curve, trials, {});

  EXPECT_EQ(curve->points[0].fit.threshold, before);
  EXPECT_FALSE(curve->points[0].answers);
}

TEST(PrecisionFrontier, HasTheNumbersOfEachContrast) {
  Plan plan;
  plan.target.phases = plan.simulation.phases = 2;
  plan.simulation.accuracy = "draft";
  plan.schedule.frames_per_presentation = {2, 2, 16};
  EffectPlanner planner;
  const auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();

  const auto choices = precision_frontier(plan, inputs, {}).value();

  ASSERT_EQ(choices.size(), 6U);
  EXPECT_TRUE(choices[3].planned);
  EXPECT_EQ(frontier_json(choices)[3]["frames_per_presentation"], Json({2, 2, 16}));
  EXPECT_EQ(choices[3].contrasts[0].uncertainty_percent, choices[2].contrasts[0].uncertainty_percent);
  EXPECT_LT(choices[3].contrasts[2].uncertainty_percent, choices[5].contrasts[2].uncertainty_percent);
}

TEST(PrecisionFrontier, HasTheTimeOfThePlanItself) {
  for (const ScheduleKind kind : {ScheduleKind::constant, ScheduleKind::adaptive}) {
    Plan plan = *load_plan("demo");
    plan.target.phases = 4;
    plan.simulation.phases = 8;
    plan.simulation.accuracy = "draft";
    plan.schedule.kind = kind;
    plan.schedule.half_width_percent = 4;
    EffectPlanner planner;
    const auto inputs = experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
    PlanPrediction prediction = predict_plan(plan, inputs).value();
    ASSERT_TRUE(predict_times(plan, inputs, prediction, {}));

    const auto choices = precision_frontier(plan, inputs, {}, prediction.figures).value();

    const auto planned = std::ranges::find_if(choices, &PrecisionChoice::planned);
    ASSERT_NE(planned, choices.end());
    EXPECT_EQ(planned->seconds, *prediction.figures.predicted_measurement_s);
    EXPECT_EQ(planned->bench_s, bill_forecast(plan, inputs).value().total_s);
  }
}

TEST(PrecisionFrontier, HasEveryChoiceAndRecommendsOne) {
  Plan plan;
  plan.target.phases = plan.simulation.phases = 4;
  plan.simulation.accuracy = "draft";
  plan.schedule.answers = AnswersChoice::graded;
  plan.schedule.frames_per_presentation = {3};
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
