// SPDX-License-Identifier: GPL-3.0-or-later
// The design of least bench time.
#include "bench/forecast/design_search.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "bench/forecast/bench_time.h"
#include "bench/forecast/bill_forecast.h"
#include "bench/forecast/decision_forecast.h"
#include "bench/forecast/ramp_advice.h"
#include "tod/schedule/schedule.h"

namespace todbench {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

struct SearchedBench {
  LoadedPlan loaded;
  ExperimentInputs inputs;
};

/// The plan of defaults with a camera: 60 s for a plate, 30 s for a mounting, 20 s for a contrast.
Plan plan_of_defaults() {
  Plan plan = *load_plan("demo");
  plan.target.phases = plan.simulation.phases = TargetPlan{}.phases;
  plan.target.plate_change_s = 60;
  plan.target.mounting_change_s = 30;
  plan.target.contrast_change_s = 20;
  plan.target.shift_change_s = 0.1;
  plan.schedule.frames_per_presentation = {0};
  plan.measurement = {};
  return plan;
}

SearchedBench bench_of(const Plan& plan) {
  LoadedPlan loaded = LoadedPlan::load(plan).value();
  EffectPlanner planner;
  ExperimentInputs inputs = experiment_inputs(loaded, planner).value();
  return {std::move(loaded), std::move(inputs)};
}

/// Ends after fewer set-ups than the plan has.
Plan adaptive_plan() {
  Plan plan = plan_of_defaults();
  plan.schedule.kind = ScheduleKind::adaptive;
  plan.schedule.half_width_percent = 4;
  return plan;
}

TEST(BillForecast, StatesTheSetUpsThatAnAdaptiveScheduleIsExpectedToVisit) {
  const SearchedBench bench = bench_of(adaptive_plan());
  const Plan plan = as_measured(with_frames(bench.loaded.plan(), bench.inputs));
  const BenchTime time = expected_bench_time(plan, bench.inputs, predict_plan(plan, bench.inputs).value());

  const BillRow changes = bill_forecast(bench.loaded.plan(), bench.inputs).value().rows.at(0);

  EXPECT_LT(time.set_ups, set_ups_of(plan.target));
  EXPECT_THAT(changes.bought, HasSubstr(fmt::format("{} set-ups", time.set_ups)));
  // The shortest change to another set-up is that of the mounting.
  EXPECT_GE(*changes.seconds, static_cast<double>(time.set_ups) * plan.target.mounting_change_s);
}

TEST(BillForecast, NamesTheFramesOfTheContrastThatDecide) {
  Plan plan = plan_of_defaults();
  plan.target.delta_t_k = {0.05};
  plan.limits.acuity.clear();
  const double s75_mrad = [&] {
    const SearchedBench bench = bench_of(plan);
    return *predict_plan(bench.loaded.plan(), bench.inputs).value().contrasts.at(0).s75_mrad;
  }();
  plan.limits.acuity = {{0.05, std::exp(-0.05) / s75_mrad}};
  const SearchedBench bench = bench_of(plan);
  const auto sentences = [&](const Plan& asked) { return bill_forecast(asked, bench.inputs).value().sentences; };

  const auto forecast = decision_forecasts(bench.loaded.plan(), bench.inputs).value().at(0);

  ASSERT_TRUE(forecast.contrast_frames);
  EXPECT_THAT(sentences(plan), Contains(AllOf(HasSubstr("No number of presentations decides"),
                                              HasSubstr(fmt::format("with {} frames of the contrast ([measurement] "
                                                                    "contrast_frames)",
                                                                    *forecast.contrast_frames)))));
  EXPECT_THAT(in_words(forecast), HasSubstr(fmt::format("with {} frames of the contrast", *forecast.contrast_frames)));
  // The designs reach what the planned contrast does not.
  double planned = 1e9, more = 1e9;
  for (const DecisionDesign& design : forecast.designs) {
    double& least = design.contrast_frames == plan.measurement.contrast_frames ? planned : more;
    least = std::min(least, design.half_width_percent);
  }
  EXPECT_LT(more, 0.7 * planned);
  plan.measurement.contrast_frames = *forecast.contrast_frames;
  EXPECT_THAT(sentences(plan), Not(Contains(HasSubstr("No number of presentations decides"))));
}

TEST(DesignSearch, CallsNoSlowerDesignTheLeastOfAnAdaptivePlan) {
  const SearchedBench bench = bench_of(adaptive_plan());

  for (const std::optional<double> asked_percent : {std::optional<double>{}, std::optional<double>{3}}) {
    const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = asked_percent}, {});

    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LE(*found->best.half_width_percent, asked_percent.value_or(*found->as_planned.half_width_percent));
    EXPECT_GE(found->best.bench_s, found->least_s);
    if (!asked_percent) {
      EXPECT_LE(found->best.bench_s, found->as_planned.bench_s);
    }
    if (found->best.plan.schedule.kind == ScheduleKind::adaptive) {
      EXPECT_THAT(in_words(*found), Contains(HasSubstr("the adaptive schedule of the plan")));
      EXPECT_THAT(in_words(*found), Not(Contains(HasSubstr("is faster than"))));
    } else {
      EXPECT_THAT(in_words(*found), Contains(HasSubstr("no constant design of this bench")));
    }
  }
}

TEST(DesignSearch, FindsLessTimeForAnAskedHalfWidthAndKeepsFiveSetUps) {
  const SearchedBench bench = bench_of(plan_of_defaults());

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 2.5}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_GE(found->set_ups, 5);
  EXPECT_LE(*found->best.half_width_percent, 2.5);
  EXPECT_LT(found->best.bench_s, 0.65 * found->as_planned.bench_s);
  EXPECT_EQ(found->best.plan.target.contrast_settling_band_percent, 10);
  ASSERT_TRUE(found->settled_s);
  EXPECT_LT(found->best.bench_s, *found->settled_s);
  EXPECT_LT(found->unpaired_share, 0.5);
  EXPECT_GE(found->best.bench_s, found->least_s);
  // The prices of plan and search are one.
  EXPECT_NEAR(laboratory_time(found->best.plan, bench.inputs, {}), found->best.bench_s, 1e-9);
}

TEST(DesignSearch, WaitsForContrastsThatAPersonSets) {
  Plan plan = plan_of_defaults();
  plan.target.kind = TargetKind::prompt;
  plan.target.black_body.clear(), plan.target.stage.clear();
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 2.5}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->best.plan.target.contrast_settling_band_percent, 0);
  EXPECT_FALSE(found->ramp) << "a person sets no ramp";
  EXPECT_FALSE(found->settled_s);
  // 2 plates, further mountings, 2 contrast changes in each set-up; the first contrast settles during the others.
  const int n = found->set_ups;
  EXPECT_NEAR(found->best.changes_s - 0.1 * 3 * n * (found->best.plan.target.phases - 1), 120 + 30 * (n - 2) + 40 * n,
              1e-6);
}

TEST(DesignSearch, ComparesARampAtTheLagThatIsAssumedAndDoesNotProposeIt) {
  Plan plan = plan_of_defaults();
  plan.target.contrast_change_s = 120;
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 2.5}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->ramp);
  EXPECT_FALSE(found->ramp->lag_is_stated);
  EXPECT_LE(*found->ramp->design.plan.schedule.ramp_k_per_s, largest_ramp_rate(16.9, 0.1));
  EXPECT_EQ(found->best.plan.schedule.kind, ScheduleKind::constant);
  EXPECT_THAT(in_words(*found), Contains(HasSubstr("a ramp from 16.9 to 0.23 K at ")));
  EXPECT_THAT(in_words(*found), Contains(HasSubstr("an assumed contrast lag of 0.1 s allows up to 1.01 K/s")));
}

TEST(DesignSearch, ProposesARampIfTheLagIsStatedAndItIsFaster) {
  Plan plan = plan_of_defaults();
  plan.target.delta_t_k = {16.9, 5, 1.93, 0.5, 0.23};
  plan.target.contrast_change_s = 60;
  plan.target.max_contrast_lag_s = 0.005;
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 2.5}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->best.plan.schedule.kind, ScheduleKind::ramp);
  EXPECT_LE(*found->best.half_width_percent, 2.5);
  EXPECT_GE(found->set_ups, 5);
  EXPECT_THAT(in_words(*found), Contains(HasSubstr("it is the fastest design")));
  const auto read = parse_plan({.origin = "design.toml", .text = to_toml(found->best.plan)}, ".");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, found->best.plan);
}

TEST(DesignSearch, TakesNoMoreTimeForARampIfThePlateLagsLess) {
  constexpr double asked_percent = 1.2;  // the lag of 0.1 s allows a rate with 1.5 %
  double before_s = 1e9;
  for (const double lag_s : {0.1, 0.01}) {
    Plan plan = plan_of_defaults();
    plan.target.max_contrast_lag_s = lag_s;
    const SearchedBench bench = bench_of(plan);

    const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = asked_percent}, {});

    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->ramp && found->ramp->meets);
    // No more precise than asked: a slower rate would only take more time.
    EXPECT_LE(*found->ramp->design.half_width_percent, asked_percent);
    EXPECT_GT(*found->ramp->design.half_width_percent, 0.93 * asked_percent);
    EXPECT_LE(found->ramp->design.bench_s, 1.02 * before_s);  // rates differ by 2 %
    before_s = found->ramp->design.bench_s;
  }
}

TEST(DesignSearch, WritesAPlanThatReadsBackAndShowsTheSetUps) {
  const SearchedBench bench = bench_of(plan_of_defaults());
  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 2.5}, {});
  ASSERT_TRUE(found) << found.error().message;

  const auto read = parse_plan({.origin = "design.toml", .text = to_toml(found->best.plan)}, ".");

  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(*read, found->best.plan);
  EXPECT_EQ(set_ups_of(read->target), static_cast<std::size_t>(found->set_ups));
}

TEST(DesignSearch, TakesNoMoreTimeForALargerHalfWidth) {
  const SearchedBench bench = bench_of(plan_of_defaults());
  double before_s = 1e9;
  for (const double percent : {1.0, 4.0}) {
    const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = percent}, {});
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_LE(*found->best.half_width_percent, percent);
    EXPECT_LE(found->best.bench_s, before_s);
    before_s = found->best.bench_s;
  }
}

TEST(DesignSearch, RejectsAHalfWidthThatCannotBeHad) {
  const SearchedBench bench = bench_of(plan_of_defaults());

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.half_width_percent = 0.05}, {});

  ASSERT_FALSE(found);
  EXPECT_THAT(found.error().message, HasSubstr("% at best"));
}

TEST(DesignSearch, NamesTheBudgetIfItLeavesALimitOpen) {
  Plan plan = plan_of_defaults();
  plan.limits = {};
  plan.limits.acuity = {{0.23, 0.28}};  // 9.7 % below the acuity of the camera
  plan.uncertainty = {};
  plan.uncertainty.rows = {{.name = "distance", .value = 200, .unit = "mm"}};  // 10 % of 2 m: +- 22 %
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.decide = true}, {});

  ASSERT_FALSE(found);
  EXPECT_THAT(
      found.error().message,
      ContainsRegex("with a probability of 95 %: at 0.23 K the acuity is (9.[0-9]|10) % from its limit, and the stated "
                    "rows of the budget make ± 2[12] %, which no presentation reduces. The trials reach "));
}

TEST(DesignSearch, DecidesFromTheLimitsAndLeavesOutContrastsThatNoLimitNames) {
  Plan plan = plan_of_defaults();
  plan.limits = {};
  plan.limits.acuity = {{0.23, 0.28}};
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.decide = true}, {});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(found->dropped_contrasts_k, ElementsAre(1.93));
  EXPECT_THAT(found->best.plan.target.delta_t_k, ElementsAre(16.9, 0.23));
  const auto forecasts = decision_forecasts(found->best.plan, bench.inputs).value();
  ASSERT_EQ(forecasts.size(), 1u);
  const auto planned = std::ranges::find_if(forecasts[0].designs, &DecisionDesign::planned);
  // The camera is 9.7 % above the limit; the curve has steps of 1 %.
  EXPECT_NEAR(forecasts[0].expected_over_limit_percent, 9.7, 0.3);
  EXPECT_GE(1 - planned->cameras.back().chances.inconclusive, 0.95);
}

TEST(DesignSearch, KeepsTheHalfWidthsForEquivalenceAtContrastsWithALimit) {
  Plan plan = plan_of_defaults();
  plan.limits = {};
  plan.limits.equivalence_margin_percent = 10;
  plan.limits.acuity = {{16.9, 0.40}, {0.23, 0.20}};
  const SearchedBench bench = bench_of(plan);

  const auto found = best_design(bench.loaded.plan(), bench.inputs, {.decide = true}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->best.contrasts.size(), 3u);
  for (const ContrastPrediction& contrast : found->best.contrasts)
    EXPECT_LE(*contrast.uncertainty_percent, 10.0 / 3) << contrast.delta_t_k;
  EXPECT_THAT(in_words(*found),
              Contains(HasSubstr("to compare camera and twin within 10 %, every half-width is at most 3.3 %")));
}

TEST(ConstantStimuli, ShowEachPlateInItsNumberOfMountings) {
  ConstantStimuliOptions options{.plates = {"a", "b"},
                                 .mountings = {all_mountings.begin(), all_mountings.end()},
                                 .mountings_per_plate = {3, 2},
                                 .delta_t_k = {2, 1},
                                 .phases = 2};
  for (const bool mounting_is_slow : {true, false}) {
    options.change_cost_s[1] = mounting_is_slow ? 100 : 0.01;
    int of_a = 0, of_b = 0;
    for (const TargetState& state : constant_stimuli(options, RandomStream(1, "test"))) {
      (state.plate == "a" ? of_a : of_b) += 1;
      if (state.plate != "b") continue;
      EXPECT_TRUE(state.mounting == Mounting::identity || state.mounting == Mounting::rotated_180);
    }
    EXPECT_EQ(of_a, 3 * 2 * 2);
    EXPECT_EQ(of_b, 2 * 2 * 2);
  }
}

}  // namespace
}  // namespace todbench
