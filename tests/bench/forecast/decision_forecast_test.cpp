// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan says of the decisions on its limits, against closed forms and counted decisions.
#include "bench/forecast/decision_forecast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/distributions/non_central_t.hpp>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/rng.h"
#include "bench/forecast/comparison_forecast.h"
#include "bench/forecast/limit_forecast.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/judgement/limit_decision.h"
#include "bench/plan/plan_options.h"
#include "bench/twin/direct_results.h"

namespace todbench {
namespace {

double normal_cdf(double z) {
  return std::erfc(-z / std::sqrt(2.0)) / 2;
}

TEST(DecisionForecasts, OfFewSetUpsAreThoseOfANoncentralT) {
  // (estimate - limit) / stated standard error is noncentral t with the distance of the camera over the true one.
  const ExpectedUncertainty expected{.se = 0.01, .interval_factor = 2.9, .degrees_of_freedom = 4};
  for (const double over : {-0.05, -0.02, 0.0, 0.02, 0.05, 0.1}) {
    const DecisionChances found = decision_chances(over, expected, {});
    const boost::math::non_central_t passes(4, over / 0.01), fails(4, -over / 0.01);
    EXPECT_NEAR(found.pass, 1 - cdf(passes, 2.9), 1e-3) << over;
    EXPECT_NEAR(found.fail, 1 - cdf(fails, 2.9), 1e-3) << over;
    EXPECT_NEAR(found.pass + found.fail + found.inconclusive, 1, 1e-12);
  }
}

TEST(DecisionForecasts, OfManyDegreesOfFreedomAreNormalWithTheRowsOfTheBudget) {
  ExpectedUncertainty expected{.se = 0.01, .interval_factor = 1.96};
  expected.stated.add(0.02, std::nullopt);
  const double u = std::hypot(0.01, 0.02);
  for (const double over : {-0.08, 0.0, 0.03, 0.08}) {
    const DecisionChances found = decision_chances(over, expected, {});
    EXPECT_NEAR(found.pass, normal_cdf(over / u - 1.96), 2e-5) << over;
    EXPECT_NEAR(found.fail, normal_cdf(-over / u - 1.96), 2e-5) << over;
  }
}

TEST(DecisionForecasts, FollowTheRuleOfThePlan) {
  const ExpectedUncertainty expected{.se = 0.01, .interval_factor = 1.96};
  LimitsPlan limits;
  limits.rule = ConformityRule::simple;
  EXPECT_NEAR(decision_chances(0.01, expected, limits).pass, normal_cdf(1), 1e-9);
  EXPECT_NEAR(decision_chances(0.01, expected, limits).inconclusive, 0, 1e-12);
  limits.rule = ConformityRule::guarded;
  const DecisionChances guarded = decision_chances(0.01, expected, limits);
  EXPECT_NEAR(guarded.fail, 1 - normal_cdf(1 - 1.96), 1e-5);
  limits.rule = ConformityRule::guarded_acceptance_and_rejection;
  limits.guard_band_risk = 0.05;
  EXPECT_NEAR(decision_chances(0.02, expected, limits).pass, normal_cdf(2 - 1.6449), 1e-4);
}

/// Shares of the decisions that decide() makes of drawn runs.
DecisionChances counted_decisions(double over, const ExpectedUncertainty& expected, const LimitsPlan& limits) {
  constexpr int draws = 40000;
  const RandomStream random(11, "test.decisions");
  const double freedom = *expected.degrees_of_freedom;
  int pass = 0, fail = 0;
  for (std::uint64_t i = 0; i < draws; ++i) {
    const double estimate = over + std::hypot(expected.se, expected.stated.u()) * random.normal(10 * i);
    double squares = 0;  // degrees of freedom of the tests are whole
    for (int k = 0; k < static_cast<int>(freedom); ++k)
      squares += std::pow(random.normal(10 * i + 1 + static_cast<std::uint64_t>(k)), 2);
    const double statistical = expected.interval_factor * expected.se * std::sqrt(squares / freedom);
    JoinedUncertainty all = expected.stated;
    all.add(statistical / distribution::quantile_above(0.025, freedom), freedom);
    const double half = std::max(statistical, all.half_width(0.025));
    const LimitAnswer answer = decide({.value = std::exp(estimate),
                                       .interval = {std::exp(estimate - half), std::exp(estimate + half)},
                                       .limit = 1,
                                       .scale = LimitScale::logarithmic},
                                      limits.rule, limits.guard_band_risk);
    pass += answer.decision == ConformityDecision::pass ? 1 : 0;
    fail += answer.decision == ConformityDecision::fail ? 1 : 0;
  }
  const double n = draws;
  return {pass / n, fail / n, (draws - pass - fail) / n};
}

TEST(DecisionForecasts, AreTheSharesOfCountedDecisions) {
  ExpectedUncertainty expected{.se = 0.012, .interval_factor = 2.5, .degrees_of_freedom = 7};
  expected.stated.add(0.015, std::nullopt);
  expected.stated.add(0.005, 3);
  for (const double over : {-0.06, -0.02, 0.03, 0.07}) {
    const DecisionChances found = decision_chances(over, expected, {}), truth = counted_decisions(over, expected, {});
    // Four standard errors of 40000 draws.
    EXPECT_NEAR(found.pass, truth.pass, 0.01) << over;
    EXPECT_NEAR(found.fail, truth.fail, 0.01) << over;
  }
}

TEST(DecisionForecasts, NameTheHalfWidthBelowWhichTheIntervalHardlyShrinks) {
  JoinedUncertainty stated;
  EXPECT_EQ(smallest_half_width_ln(stated), 0);
  stated.add(0.02, std::nullopt);

  const double least = smallest_half_width_ln(stated), floor = stated.half_width(0.025);

  EXPECT_NEAR(std::hypot(least, floor), 1.05 * floor, 1e-12);
}

/// The acceptance plan with a fleet, and limits near its camera.
LoadedPlan acceptance_near_its_limits() {
  Plan plan = *load_plan("acceptance");
  plan.limits.acuity = {{16.9, 0.47}, {0.23, 0.30}};
  plan.limits.fleet_sd_percent = 3;
  return LoadedPlan::load(plan).value();
}

TEST(DecisionForecasts, AgreeWithTheLimitForecastAboutOneCamera) {
  const LoadedPlan loaded = acceptance_near_its_limits();
  EffectPlanner planner;
  const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  const Plan measured = as_measured(with_frames(loaded.plan(), inputs));
  const auto limits = limit_forecasts(loaded.plan(), predict_plan(measured, inputs).value());
  const auto decisions = decision_forecasts(loaded.plan(), inputs);

  ASSERT_TRUE(limits && decisions);
  ASSERT_EQ(limits->size(), decisions->size());
  for (std::size_t i = 0; i < limits->size(); ++i) {
    const DecisionForecast& decision = (*decisions)[i];
    const auto planned = std::ranges::find_if(decision.designs, &DecisionDesign::planned);
    ASSERT_NE(planned, decision.designs.end());
    const LimitForecast& limit = (*limits)[i];
    EXPECT_NEAR(100 * (limit.expected_acuity_per_mrad / limit.least_acuity_per_mrad - 1),
                decision.expected_over_limit_percent, 1e-6);
    // The cameras are in steps of 1 %: the chance of the camera from which 95 % pass lies between those of neighbours.
    const double over = 100 * (limit.planned.passes_95_from_per_mrad / limit.least_acuity_per_mrad - 1);
    for (const CameraChance& camera : planned->cameras) {
      if (camera.over_limit_percent < over) {
        EXPECT_LE(camera.chances.pass, 0.951) << camera.over_limit_percent;
      } else {
        EXPECT_GE(camera.chances.pass, 0.949) << camera.over_limit_percent;
      }
    }
  }
}

TEST(Thresholds, OfAPlanAreThoseOfDirectEstimatesAfterRefinement) {
  Plan plan;
  plan.camera.ifov_mrad = 1.3085;
  plan.target.delta_t_k = {16.9, 0.23};
  plan.target.distance_m = 2;
  plan.target.plates = {"tcat-a", "tcat-b"};
  plan.simulation.sensor = "sc2000";
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  EffectPlanner planner;
  ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  ASSERT_EQ(inputs.outlooks.size(), 2u);
  const double first_mrad = inputs.outlooks[1].s75_pitch * inputs.sensor.ifov_mrad();

  ASSERT_TRUE(refine_thresholds(inputs, 1, {}));

  // Fits of two sessions of the acceptance plan with the emulated camera at 0.23 K: 3.44 and 3.45 mrad.
  EXPECT_LT(first_mrad, 3.35) << "the first tier is lower: the refinement has something to do";
  EXPECT_NEAR(inputs.outlooks[1].s75_pitch * inputs.sensor.ifov_mrad(), 3.445, 0.035);
  EXPECT_NEAR(inputs.outlooks[0].s75_pitch * inputs.sensor.ifov_mrad(), 2.09, 0.02);
}

TEST(DecisionForecasts, ShowTimeAgainstTheProbabilityOfADecision) {
  const LoadedPlan loaded = acceptance_near_its_limits();
  EffectPlanner planner;
  const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();

  const auto forecasts = decision_forecasts(loaded.plan(), inputs);

  ASSERT_TRUE(forecasts) << forecasts.error().message;
  ASSERT_EQ(forecasts->size(), 2u);
  for (const DecisionForecast& forecast : *forecasts) {
    ASSERT_GE(forecast.designs.size(), 7u);
    ASSERT_GE(forecast.rows.size(), 5u);
    EXPECT_GE(forecast.rows[0].half_width_percent, forecast.rows[1].half_width_percent);
    EXPECT_GT(forecast.floor_percent, forecast.rows[0].half_width_percent);
    EXPECT_EQ(std::ranges::count_if(forecast.designs, &DecisionDesign::planned), 1);
    double before_s = 0;
    for (const DecisionDesign& design : forecast.designs) {
      EXPECT_GE(design.bench_s, before_s);
      before_s = design.bench_s;
      ASSERT_EQ(design.cameras.size(), 21u);
      EXPECT_GT(design.cameras.back().chances.pass, design.cameras[10].chances.pass);
      EXPECT_GT(design.cameras.front().chances.fail, design.cameras[10].chances.fail);
      EXPECT_LT(design.cameras[10].chances.pass, 0.05);  // at the limit: by the guard band at most 2.5 %
      ASSERT_TRUE(design.consumer_risk && design.producer_risk);
      EXPECT_LT(*design.consumer_risk, 0.025);
      EXPECT_GE(design.deciding_percent, design.half_width_percent);
    }
    const auto& designs = forecast.designs;
    EXPECT_LT(designs.back().half_width_percent, designs.front().half_width_percent);
    EXPECT_GT(designs.back().deciding_percent, 0.99 * forecast.floor_percent);
  }
  // The rows of the black body matter at 0.23 K and hardly at 16.9 K.
  EXPECT_GT((*forecasts)[1].smallest_half_width_percent, (*forecasts)[0].smallest_half_width_percent);
}

TEST(Recommendation, OfFramesStopsWhereTheBudgetDecides) {
  Plan plan = *load_plan("acceptance");
  plan.limits = {};
  plan.target.plate_change_s = 60, plan.target.mounting_change_s = 30, plan.target.contrast_change_s = 20;
  plan.schedule.frames_per_presentation = {8};
  const auto recommended = [](const Plan& asked) {
    const LoadedPlan loaded = LoadedPlan::load(asked).value();
    EffectPlanner planner;
    const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
    const auto choices = precision_frontier(loaded.plan(), inputs, {}).value();
    const auto best = std::ranges::find_if(choices, &PrecisionChoice::recommended);
    return best == choices.end() ? 0.0 : *best->half_width_percent;
  };
  Plan without = plan;
  without.uncertainty = {};
  plan.uncertainty = {};
  plan.uncertainty.rows = {{.name = "black-body-calibration", .value = 50, .unit = "mK"}};  // a fifth of 0.23 K

  EXPECT_GT(recommended(plan), recommended(without));
}

TEST(ComparisonForecasts, UseThePairsThatDecide) {
  Plan plan = *load_plan("demo");
  plan.limits.equivalence_margin_percent = 2.5;
  const LoadedPlan loaded = LoadedPlan::load(plan).value();
  EffectPlanner planner;
  const ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  Plan unpaired = plan;
  unpaired.simulation.paired = false;

  const auto power_of = [&](const Plan& asked) {
    const auto outlook = comparison_forecast(asked, predict_plan(asked, inputs).value()).outlook;
    return outlook ? outlook->power : -1;
  };

  EXPECT_GT(power_of(plan), power_of(unpaired));
}

}  // namespace
}  // namespace todbench
