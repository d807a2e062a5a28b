// SPDX-License-Identifier: GPL-3.0-or-later
// Packages with a scale of their own: a gain is no enhancement, and a result without a threshold is none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bench/enhance/decidable.h"
#include "bench/model_comparison/model_comparison.h"
#include "bench/scene_dependence/scene_dependence.h"
#include "tests/bench/enhance/scale_invariance.h"

namespace todbench {
namespace {

using ::testing::HasSubstr;
using namespace testing_support;

LoadedPlan with_observer(const LoadedPlan& plan, double blur, double internal, double factor) {
  PlanParts parts = plan.parts();
  parts.observer.blur_sigma_samples = blur;
  parts.observer.internal_noise = internal;
  parts.observer.sensor_noise_factor = factor;
  return LoadedPlan::of(plan.plan(), parts).value();
}

void expect_gains_are_none(const LoadedPlan& plan, const std::vector<double>& gains) {
  std::vector<EnhancementPackage> packages;
  for (const double gain : gains) packages.push_back(gain_of(gain));

  const auto found = compare_packages(plan, packages, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const PackageResult& result = found->results[i + 1];
    ASSERT_FALSE(result.error) << result.error->message;
    ASSERT_TRUE(result.ratios.at(0).ratio) << result.ratios.at(0).withheld;
    EXPECT_NEAR(*result.ratios.at(0).ratio, 1, 0.02) << gains[i];
    EXPECT_NEAR(judged_point(result, 4)->gain, gains[i], 0.005) << gains[i];
  }
}

// Noise of 7 counts of 10 mK: at a third of the gain rounding adds 2 % to its variance, which is a thousandth of the
// observer's own at 4 K.
TEST(Enhancement, OfAGainIsNone) {
  expect_gains_are_none(small_plan("4", 4), {0.3, 3});
}

// Whole counts of 10 mK are steps of 33 mK behind a gain of 0.3, half the noise. They change fewer than one answer in
// 80 of this observer, whose internal noise is small; in this small plan one answer moves the ratio by 7 %. Over 16
// seeds ln ratio is +0.004 +- 0.008.
TEST(Enhancement, OfAGainIsNoneButForTheRoundingOfTheAnswersOfAnObserverWithLittleNoise) {
  for (const double kelvin_per_count : {0.01, 0.001}) {
    const auto plan = plan_of_counts("human-like-1", 4, 1, kelvin_per_count);

    const auto found = compare_packages(plan, {gain_of(0.3), gain_of(3)}, {}, {});

    ASSERT_TRUE(found) << found.error().message;
    const Moved third = moved_by(found->results[1], found->results[0]);
    const Moved treble = moved_by(found->results[2], found->results[0]);
    EXPECT_LE(third.answers, kelvin_per_count > 0.005 ? 2 / 80.0 : 0);
    EXPECT_LE(std::abs(third.ln_ratio), third.half_width.value());
    EXPECT_EQ(treble.answers, 0);
    EXPECT_EQ(treble.ln_ratio, 0);
  }
}

TEST(ModelComparison, OfAGainIsNone) {
  ComparedModel none, third;
  none.kind = third.kind = ModelKind::package;
  none.name = none.package.name = "none";
  third.name = "third";
  third.package = gain_of(0.3);

  const auto found = compare_models(small_plan("4", 4), none, third, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->ratios.at(0).ratio) << found->ratios.at(0).withheld;
  EXPECT_NEAR(*found->ratios.at(0).ratio, 1, 0.02);
}

TEST(Enhancement, ThatIsCutOffHasNoRatio) {
  // The surround is at 5000 of 16383 counts: behind a gain of 3.2 it is at 16000, and 4 K more are cut off.
  const auto found = compare_packages(small_plan("4", 4), {gain_of(3.2), gain_of(10)}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const PackageResult &partly = found->results[1], &entirely = found->results[2];
  ASSERT_FALSE(partly.error) << partly.error->message;
  EXPECT_GT(partly.clipped_pixels, 0u);
  EXPECT_FALSE(partly.ratios.at(0).ratio);
  EXPECT_NE(partly.ratios.at(0).withheld, "");
  EXPECT_EQ(exit_code(partly), 3);
  ASSERT_TRUE(entirely.error);
  EXPECT_EQ(entirely.error->code, ErrorCode::not_identifiable);
  EXPECT_THAT(entirely.error->message, HasSubstr("behind the stages"));
}

TEST(Enhancement, ByStagesThatAreNotLinearSaysSo) {
  const StagePlan agc{.kind = StagePlan::Kind::agc, .plateau_counts = 10}, sharpen{.kind = StagePlan::Kind::sharpen};

  const auto found = compare_packages(small_plan("4, 0.6", 2),
                                      {package_of({agc}, "equaliser"), package_of({sharpen}, "sharpener")}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  const JudgedPoint high = judged_point(found->results[1], 4).value(),
                    low = judged_point(found->results[1], 0.6).value();
  ASSERT_EQ(found->warnings.size(), 1u) << high.gain << " +- " << high.gain_error << ", " << low.gain << " +- "
                                        << low.gain_error;
  EXPECT_THAT(found->warnings[0], HasSubstr("equaliser: its stages are not linear"));
}

TEST(SceneDependence, BehindAGainThatCutsOffIsInconclusive) {
  const auto plan = small_plan("4", 2);
  const SceneDependenceOptions options{.cycles = 3, .frames = 4};
  const EnhancementPackage third = gain_of(0.3), cut_off = gain_of(3.2);

  const auto fine = plan_scene_dependence(plan, &third, 40, options, {}, {});
  const auto clipped = plan_scene_dependence(plan, &cut_off, 40, options, {}, {});

  ASSERT_TRUE(fine) << fine.error().message;
  ASSERT_TRUE(clipped) << clipped.error().message;
  EXPECT_NE(fine->verdict, SceneDependenceVerdict::depends);
  EXPECT_EQ(clipped->verdict, SceneDependenceVerdict::inconclusive);
  EXPECT_THAT(clipped->notes.back(), HasSubstr("clipped at an end of the counts"));
}

TEST(Enhancement, ByARecursiveFilterIsThatOfAveragedFramesForAnObserverOfLimitedEfficiency) {
  // A share of a fifth leaves a ninth of the variance, as nine averaged frames do.
  const auto plan = with_observer(small_plan("0.6", 12), 0.5, 0.025, 1.75);
  const StagePlan fifth{.kind = StagePlan::Kind::recursive, .share = 0.2};
  PlanParts parts = plan.parts();
  parts.sensor.frames_averaged = 9;

  const auto found = compare_packages(plan, {package_of({fifth})}, {}, {});
  const auto quiet = compare_packages(LoadedPlan::of(plan.plan(), parts).value(), {}, {}, {});

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(quiet) << quiet.error().message;
  ASSERT_FALSE(found->results[1].error) << found->results[1].error->message;
  const auto &filtered = found->results[1].curve.points.at(0).fit, &averaged = quiet->results[0].curve.points.at(0).fit;
  ASSERT_TRUE(filtered.threshold && averaged.threshold);
  const double se = std::hypot(filtered.se_ln_threshold.value(), averaged.se_ln_threshold.value());
  EXPECT_NEAR(std::log(*filtered.threshold / *averaged.threshold), 0, 4 * se);
  EXPECT_LT(*filtered.threshold, 0.8 * *found->results[0].curve.points.at(0).fit.threshold);
}

}  // namespace
}  // namespace todbench
