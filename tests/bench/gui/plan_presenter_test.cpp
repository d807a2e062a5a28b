// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/gui/presenters/plan_presenter.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "bench/twin/direct_results.h"
#include "tests/bench/gui/gui_test_support.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using testing::wait_until;

struct PlanBench {
  testing::TemporaryFolder folder;
  Workbench bench{folder.path()};
  PlanPresenter presenter{bench};
  ~PlanBench() { bench.shut_down(); }
};

TEST(PlanPresenter, RefusesWhatAPlanFileMayNotSayAndKeepsTheOldPlan) {
  PlanBench b;
  Plan plan = b.presenter.plan();
  plan.target.distance_m = -1;

  const QString wrong = b.presenter.apply(plan);

  EXPECT_THAT(wrong.toStdString(), HasSubstr("distance_m"));
  EXPECT_GT(b.presenter.plan().target.distance_m, 0);
}

TEST(PlanPresenter, ShowsAsTomlWhatTheFormSaysAndTheOtherWayRound) {
  PlanBench b;
  Plan plan = b.presenter.plan();
  plan.operator_name = "P. Example";

  EXPECT_EQ(b.presenter.apply(plan).toStdString(), "");
  EXPECT_THAT(b.presenter.toml().toStdString(), HasSubstr("P. Example"));
  EXPECT_EQ(b.presenter.apply_toml(b.presenter.toml().replace("P. Example", "Q. Other")).toStdString(), "");

  EXPECT_EQ(b.presenter.plan().operator_name, "Q. Other");
}

TEST(PlanPresenter, TakesChangesBackAndMakesThemAgain) {
  PlanBench b;
  const Plan first = b.presenter.plan();
  Plan second = first;
  second.operator_name = "P. Example";
  ASSERT_EQ(b.presenter.apply(second), "");
  for (const double percent : {2.0, 3.0, 4.0}) ASSERT_EQ(b.presenter.set_tolerance_percent(percent), "");
  const Plan third = b.presenter.plan();

  b.presenter.undo();
  EXPECT_EQ(b.presenter.plan(), second) << "one way of the slider is one change";
  b.presenter.undo();
  EXPECT_EQ(b.presenter.plan(), first);
  EXPECT_FALSE(b.presenter.can_undo());
  b.presenter.undo();
  EXPECT_EQ(b.presenter.plan(), first);
  b.presenter.redo();
  b.presenter.redo();
  EXPECT_EQ(b.presenter.plan(), third);
  EXPECT_FALSE(b.presenter.can_redo());
  b.presenter.undo();
  Plan other = second;
  other.place = "elsewhere";
  ASSERT_EQ(b.presenter.apply(other), "");
  EXPECT_FALSE(b.presenter.can_redo()) << "another way was taken";
  ASSERT_TRUE(b.bench.select_device("sim:sc2000"));
  EXPECT_FALSE(b.presenter.can_undo()) << "older plans are for another device";
}

TEST(PlanPresenter, CountsTheAnswersOfAPlan) {
  PlanBench b;

  // 2 plates of 20 triangles, 4 mountings, 3 contrasts, 6 phases.
  EXPECT_EQ(b.presenter.outlook().presentations, 2u * 4 * 3 * 6);
  EXPECT_EQ(b.presenter.outlook().trials, 2u * 20 * 4 * 3 * 6);
}

TEST(PlanPresenter, NeedsFourTimesTheAnswersForHalfTheUncertainty) {
  PlanBench b;
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast().has_value(); }));

  Plan plan = b.presenter.plan();
  plan.target.phases = 8;
  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");
  const auto coarse = b.presenter.outlook().uncertainty_percent();
  const double coarse_s = b.presenter.outlook().bench_s;
  plan.target.phases = 32;
  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");
  const auto fine = b.presenter.outlook().uncertainty_percent();

  ASSERT_TRUE(coarse && fine) << "in the call, without waiting";
  // expm1 of half the exponent: exactly a half only for small ones.
  EXPECT_NEAR(std::log1p(*coarse / 100) / std::log1p(*fine / 100), 2, 1e-9);
  EXPECT_GT(b.presenter.outlook().bench_s, coarse_s);
}

TEST(PlanPresenter, ForeseesWhatTheCommandLinePredicts) {
  PlanBench b;
  ASSERT_EQ(b.presenter.set_tolerance_percent(4).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return b.presenter.expected_known(); }));
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast_current() && !b.presenter.prices().empty(); }));

  const auto loaded = LoadedPlan::load(b.presenter.plan());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EffectPlanner planner;
  auto inputs = experiment_inputs(*loaded, planner);
  ASSERT_TRUE(inputs);
  ASSERT_TRUE(refine_thresholds(*inputs, loaded->plan().seed, {}));
  auto predicted = predict_plan(loaded->plan(), *inputs);
  ASSERT_TRUE(predicted && predict_times(loaded->plan(), *inputs, *predicted, {}));

  // Both time the machine, each at its own moment.
  ASSERT_TRUE(b.presenter.outlook().twin_s);
  EXPECT_LT(std::abs(std::log(*b.presenter.outlook().twin_s / *predicted->figures.predicted_s)), std::log(3));
  ASSERT_EQ(b.presenter.outlook().contrasts.size(), predicted->contrasts.size());
  for (std::size_t i = 0; i < predicted->contrasts.size(); ++i) {
    EXPECT_EQ(b.presenter.outlook().contrasts[i].twin_uncertainty_percent, predicted->contrasts[i].uncertainty_percent);
    EXPECT_EQ(b.presenter.outlook().contrasts[i].s75_mrad, predicted->contrasts[i].s75_mrad);
  }
  const auto& decisions = b.presenter.forecast()->effects.decisions;
  ASSERT_EQ(decisions.size(), inputs->effects.decisions.size());
  for (std::size_t i = 0; i < decisions.size(); ++i) {
    EXPECT_EQ(decisions[i].decision, inputs->effects.decisions[i].decision);
    EXPECT_EQ(decisions[i].reason, inputs->effects.decisions[i].reason);
    EXPECT_EQ(decisions[i].predicted_change_percent, inputs->effects.decisions[i].predicted_change_percent);
  }
}

TEST(PlanPresenter, SkipsMoreEffectsWhereMoreMayBeWrong) {
  PlanBench b;
  const auto simulated = [&] {
    const auto& decisions = b.presenter.forecast()->effects.decisions;
    return std::count_if(decisions.begin(), decisions.end(),
                         [](const EffectDecision& d) { return d.decision == Decision::simulate; });
  };

  ASSERT_EQ(b.presenter.set_tolerance_percent(0.01).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast_current(); }));
  const auto strict = simulated();
  ASSERT_EQ(b.presenter.set_tolerance_percent(20).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast_current(); }));

  EXPECT_LT(simulated(), strict);
}

TEST(PlanPresenter, SetsAsManyPhasesAsTheToleranceNeedsAndNoMore) {
  PlanBench b;
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast().has_value(); }));

  ASSERT_EQ(b.presenter.set_tolerance_percent(5).toStdString(), "");
  const int phases = b.presenter.plan().target.phases;
  EXPECT_LE(*b.presenter.outlook().uncertainty_percent(), 5);
  Plan fewer = b.presenter.plan();
  fewer.target.phases = phases - 1;
  ASSERT_EQ(b.presenter.apply(fewer).toStdString(), "");

  EXPECT_GT(*b.presenter.outlook().uncertainty_percent(), 5);
}

TEST(PlanPresenter, KnowsThePriceOfEveryAccuracyBeforeItIsPaid) {
  PlanBench b;

  ASSERT_TRUE(wait_until([&] { return !b.presenter.prices().empty(); }));

  const auto& prices = b.presenter.prices();
  ASSERT_GE(prices.size(), 3u);
  for (std::size_t i = 1; i < prices.size(); ++i) {
    EXPECT_GT(prices[i].tolerance_percent, prices[i - 1].tolerance_percent);
    EXPECT_LE(prices[i].bench_s, prices[i - 1].bench_s);
    EXPECT_LE(prices[i].phases, prices[i - 1].phases);
  }
  // A price is what the slider then asks for.
  ASSERT_EQ(b.presenter.set_tolerance_percent(prices.back().tolerance_percent).toStdString(), "");
  EXPECT_EQ(b.presenter.plan().target.phases, prices.back().phases);
  EXPECT_EQ(b.presenter.outlook().bench_s, prices.back().bench_s);
  const Plot plot = accuracy_plot(prices, b.presenter.outlook());
  EXPECT_EQ(plot.series.front().points.size(), prices.size());
}

TEST(PlanPresenter, SkipsAndForcesEffectsByHandInTheSameToml) {
  PlanBench b;

  ASSERT_EQ(b.presenter.choose(Effect::temporal_noise, EffectChoice::skip).toStdString(), "");
  ASSERT_EQ(b.presenter.choose(Effect::diffraction, EffectChoice::simulate).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast_current(); }));

  EXPECT_EQ(b.presenter.choice(Effect::temporal_noise), EffectChoice::skip);
  EXPECT_THAT(b.presenter.toml().toStdString(), HasSubstr("temporal_noise"));
  EXPECT_FALSE(b.presenter.forecast()->effects.simulates(Effect::temporal_noise));
  EXPECT_TRUE(b.presenter.forecast()->effects.simulates(Effect::diffraction));
  ASSERT_EQ(b.presenter.choose(Effect::temporal_noise, EffectChoice::planner).toStdString(), "");
  ASSERT_TRUE(wait_until([&] { return b.presenter.forecast_current(); }));
  EXPECT_TRUE(b.presenter.forecast()->effects.simulates(Effect::temporal_noise));
}

TEST(PlanPresenter, SaysThatAPlateDoesNotFitBeforeAnythingIsMeasured) {
  PlanBench b;
  Plan plan = b.presenter.plan();
  plan.target.distance_m = 0.4;

  ASSERT_EQ(b.presenter.apply(plan).toStdString(), "");

  EXPECT_TRUE(wait_until([&] { return b.presenter.misfit().contains("distance_m"); }));
}

}  // namespace
}  // namespace todbench
