// SPDX-License-Identifier: GPL-3.0-or-later
// What a plan says of a ramp before it is measured.
#include "bench/forecast/ramp_forecast.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/comparison_forecast.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/precision_frontier.h"
#include "bench/forecast/ramp_advice.h"
#include "bench/plan/descriptions.h"
#include "bench/plan/plan_options.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A bench of defaults with the simulated SC2000 and six phases.
Plan ramp_plan(double k_per_s, double lag_s = 0) {
  Plan plan;
  plan.camera.id = "sim:sc2000";
  plan.camera.ifov_mrad = load_sensor("sc2000")->ifov_mrad();
  plan.target.kind = TargetKind::scpi;
  plan.target.black_body = plan.target.stage = "127.0.0.1:1";
  plan.target.phases = plan.simulation.phases = 6;
  plan.target.max_contrast_lag_s = lag_s;
  plan.schedule.kind = ScheduleKind::ramp;
  plan.schedule.ramp_k_per_s = k_per_s;
  plan.schedule.from_delta_t_k = 16.9;
  plan.schedule.to_delta_t_k = 0.23;
  plan.simulation.sensor = "sc2000";
  plan.simulation.accuracy = "draft";
  return plan;
}

ExperimentInputs inputs_of(const Plan& plan) {
  EffectPlanner planner;
  return experiment_inputs(LoadedPlan::load(plan).value(), planner).value();
}

PlanPrediction predicted(const Plan& plan) {
  return predict_plan(as_measured(plan), inputs_of(plan)).value();
}

TEST(EqualPresentations, OfAConstantStretchAreThoseOfAllContrasts) {
  // Up to 5 K all u are below 0.05.
  const std::vector<ContrastInformation> points{{20, 3, 0.1}, {10, 3, 0.1}};
  const std::vector<double> shown{20, 15, 12, 10, 10, 12, 15, 20};

  for (const double equal : equal_presentations(points, shown, {.noise_k = 0.07})) EXPECT_NEAR(equal, 8, 1e-9);
}

TEST(EqualPresentations, ShareThreeParametersBetweenThreeContrasts) {
  // Three contrasts determine three parameters: each has its own presentations alone.
  const std::vector<ContrastInformation> points{{16.9, 2, 0.1}, {0.5, 1, 0.2}, {0.23, 3, 0.3}};
  const std::vector<double> shown{16.9, 16.9, 16.9, 0.5, 0.5, 0.23, 0.23, 0.23, 0.23};

  const auto equal = equal_presentations(points, shown, {.noise_k = 0.07});

  EXPECT_NEAR(equal[0], 3, 1e-6);
  EXPECT_NEAR(equal[1], 2, 1e-6);
  EXPECT_NEAR(equal[2], 4, 1e-6);
}

TEST(NearestPresentations, AreCountedByRatio) {
  const std::vector<double> points{10, 1}, shown{10, 4, 3, 1, 0.5};
  EXPECT_THAT(nearest_presentations(points, shown), ElementsAre(2, 3));
}

TEST(RampContrasts, LagBehindASlowBlackBodyAndStayAtTheEnd) {
  Plan plan = ramp_plan(7.3);
  plan.target.kind = TargetKind::scene;
  const std::vector<double> quick = ramp_contrasts_k(plan);
  plan.target.kind = TargetKind::scpi;
  plan.target.contrast_change_s = 40;
  const std::vector<double> slow = ramp_contrasts_k(plan);

  EXPECT_EQ(quick.size(), 2 * ramp_steps(ramp_options(plan, {}, 1)));
  EXPECT_NEAR(*std::ranges::min_element(quick), 0.23, 1e-9);
  EXPECT_GT(slow.size(), quick.size());
  EXPECT_GT(slow[5], quick[5]);
  EXPECT_NEAR(*std::ranges::min_element(slow), 0.23 * 1.1, 0.02);
  EXPECT_EQ(ramp_hold + slow.size() * set_ups_of(plan.target),
            bench_time(plan, inputs_of(plan).plates, 50, {}).presentations);
}

// Half-widths of simulated runs of the SC2000 (seed 1).
TEST(RampForecast, IsSafeAndWithinTwiceThatOfRuns) {
  struct Run {
    double k_per_s;
    int frames;
    std::vector<double> had_percent, trials;
  };
  for (const Run& run :
       {Run{7.3, 18, {0.38, 0.28, 1.38}, {1920, 3200, 1600}}, Run{20, 4, {0.87, 0.67, 4.28}, {640, 1280, 640}}}) {
    Plan plan = ramp_plan(run.k_per_s);
    plan.target.kind = TargetKind::scene;
    plan.schedule.frames_per_presentation = {run.frames};
    const PlanPrediction prediction = predicted(plan);
    ASSERT_EQ(prediction.contrasts.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
      const ContrastPrediction& contrast = prediction.contrasts[i];
      EXPECT_GT(*contrast.uncertainty_percent, run.had_percent[i]) << contrast.delta_t_k;
      EXPECT_LT(*contrast.uncertainty_percent, 2.1 * run.had_percent[i]) << contrast.delta_t_k;
      EXPECT_EQ(contrast.trials, run.trials[i]) << contrast.delta_t_k;
    }
  }
}

TEST(RampForecast, NarrowsWithTheRootOfThePresentations) {
  Plan plan = ramp_plan(6.4);
  plan.target.kind = TargetKind::scene;  // no black body waits at the low end
  const PlanPrediction fast = predicted(plan);
  plan.schedule.ramp_k_per_s = 1.6;
  const PlanPrediction slow = predicted(plan);

  EXPECT_NEAR(static_cast<double>(slow.figures.trials) / static_cast<double>(fast.figures.trials), 4, 0.2);
  // At the low contrast the noise decides; at the high ones, the tables of the function of the twin.
  const double ratio = fast.contrasts[2].se_ln_s75 / slow.contrasts[2].se_ln_s75;
  EXPECT_NEAR(ratio, 2, 0.4);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(slow.contrasts[i].se_ln_s75, fast.contrasts[i].se_ln_s75) << i;
}

TEST(RampForecast, OfBillFrontierAndDecisionsFollowsTheRate) {
  Plan fast = ramp_plan(7.3);
  fast.limits.acuity = {{0.23, 0.28}};
  Plan slow = fast;
  slow.schedule.ramp_k_per_s = 0.8;
  const ExperimentInputs inputs = inputs_of(fast);
  const auto half_of = [&](const Plan& plan) {
    const auto choices = precision_frontier(plan, inputs, {}).value();
    EXPECT_EQ(choices.size(), 1u) << "other frames would change the rate";
    EXPECT_TRUE(choices.front().planned);
    return *choices.front().half_width_percent;
  };
  EXPECT_LT(half_of(slow), 0.75 * half_of(fast));
  EXPECT_NE(bill_forecast(fast, inputs)->rows[4].bought, bill_forecast(slow, inputs)->rows[4].bought);

  const auto forecast = decision_forecasts(fast, inputs).value().at(0);
  std::vector<double> rates, half_widths;
  for (const DecisionDesign& design : forecast.designs) {
    rates.push_back(design.ramp_k_per_s.value_or(0));
    half_widths.push_back(design.half_width_percent);
  }
  EXPECT_THAT(rates, ElementsAre(29.2, 14.6, 7.3, 3.65, 1.825));
  EXPECT_TRUE(std::ranges::is_sorted(half_widths, std::ranges::greater{}));
}

TEST(RampForecast, OfDecisionsHasNoRateBeyondTheLagExceptThePlannedOne) {
  const auto rates_of = [](double planned_k_per_s) {
    Plan plan = ramp_plan(planned_k_per_s, 0.01);
    plan.limits.acuity = {{0.23, 0.28}};
    std::vector<double> rates;
    for (const DecisionDesign& design : decision_forecasts(plan, inputs_of(plan)).value().at(0).designs)
      rates.push_back(design.ramp_k_per_s.value_or(0));
    std::ranges::sort(rates);
    return rates;
  };
  const double largest = largest_ramp_rate(16.9, 0.01);  // 10.1 K/s

  EXPECT_THAT(rates_of(8), ElementsAre(2, 4, 8, largest));
  EXPECT_THAT(rates_of(16), ElementsAre(4, 8, largest, 16));
}

TEST(RampForecast, OfTheComparisonCountsTheTrialsOfTheRamp) {
  Plan plan = ramp_plan(7.3);
  plan.simulation.phases = 60;
  const PlanPrediction prediction = predicted(plan);
  EXPECT_THAT(comparison_forecast(plan, prediction).sentence,
              HasSubstr("(" + std::to_string(std::lround(prediction.contrasts[1].trials)) + " planned)"));
}

std::string advice_of(const Plan& plan) {
  return ramp_advice(plan, inputs_of(plan));
}

std::string seconds_of(Plan plan) {
  const ExperimentInputs inputs = inputs_of(plan);
  plan = with_frames(plan, inputs);
  return std::to_string(std::lround(bench_time(plan, inputs.plates, 50, {}).total_s())) + " s (";
}

/// The plan with settled contrasts, its own phases, and frames that the program chooses.
Plan constant_of(Plan plan, double band_percent) {
  plan.schedule = {};
  plan.target.contrast_settling_band_percent = band_percent;
  return plan;
}

TEST(RampAdvice, StatesTheTimesOfEveryWayAtItsOwnRate) {
  const Plan slow = ramp_plan(0.8, 0.03);

  const std::string advice = advice_of(slow);

  EXPECT_THAT(advice, StartsWith("the ramp at 0.8 K/s takes " + seconds_of(slow)));
  EXPECT_THAT(advice, HasSubstr("a contrast lag of 0.03 s allows up to 3.38 K/s, which takes " +
                                seconds_of(ramp_plan(3.38, 0.03))));
  EXPECT_THAT(advice, HasSubstr("(schedule kind \"constant\") take " + seconds_of(constant_of(slow, 0))));
  EXPECT_THAT(advice, HasSubstr("(contrast_settling_band_percent = 10) " + seconds_of(constant_of(slow, 10))));
  EXPECT_THAT(advice, HasSubstr("take one of these"));
}

TEST(RampAdvice, ProposesSettledContrastsThatAreAboutAsFast) {
  const std::string advice = advice_of(ramp_plan(3.38, 0.03));
  EXPECT_THAT(advice, HasSubstr("take one of these"));
  EXPECT_THAT(advice, Not(HasSubstr("allows up to"))) << "the rate of the plan is the largest one";
}

TEST(RampAdvice, NeedsNoLag) {
  EXPECT_THAT(advice_of(ramp_plan(0.2, 0)), HasSubstr("take one of these"));
  EXPECT_THAT(advice_of(ramp_plan(7.3, 0)), HasSubstr("take the band"));
}

TEST(RampAdvice, NamesTheRateThatTheLagAllows) {
  EXPECT_THAT(
      advice_of(ramp_plan(7.3, 0.03)),
      StartsWith("a contrast lag of 0.03 s at 7.3 K/s changes the contrast between large and small triangles by "
                 "1.3 %; up to 3.38 K/s it stays below 0.6 %, and the ramp takes " +
                 seconds_of(ramp_plan(3.38, 0.03))));
  EXPECT_THAT(advice_of(ramp_plan(3.38, 0.005)), HasSubstr("the largest rate is the fastest way"));
}

TEST(RampAdvice, IsNoneWhereTheRampIsFastest) {
  Plan plan = ramp_plan(7.3, 0.01);
  plan.target.contrast_change_s = 60;
  plan.target.delta_t_k = {16.9, 5, 1.93, 0.5, 0.23};
  EXPECT_EQ(advice_of(plan), "");
  EXPECT_EQ(advice_of(constant_of(plan, 0)), "");
}

}  // namespace
}  // namespace todbench
