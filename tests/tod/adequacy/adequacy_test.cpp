// SPDX-License-Identifier: GPL-3.0-or-later
// What speaks against a threshold: found where a model is wrong, not found where it is right.
#include "tod/adequacy/adequacy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/tod/adequacy/adequacy_support.h"
#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/guessing.h"

namespace todbench {
namespace {

using testing::AdequacyDesign;
using ::testing::AllOf;
using ::testing::Contains;
using testing::drawn;
using ::testing::Field;
using testing::finding_shares;
using testing::geometric;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::point_by_twin;

auto of_kind(FindingKind kind) {
  return Contains(Field(&AdequacyFinding::kind, kind));
}
auto unfit_of_kind(FindingKind kind) {
  return Contains(AllOf(Field(&AdequacyFinding::kind, kind), Field(&AdequacyFinding::unfit, true)));
}

// Counts rounded from their expectation, so that nothing depends on chance.
std::vector<Level> expected_counts(PsychometricForm form, double slope, double lapse, int sizes, double trials) {
  std::vector<Level> levels;
  for (const double size : geometric(0.5, 2.0, sizes))
    levels.push_back({size, std::round(trials * psychometric(form, size, 1, slope, lapse)), trials, -1});
  return levels;
}

Adequacy adequacy_of(const std::vector<Level>& levels, const FitOptions& options) {
  return adequacy(levels, fit_psychometric(levels, options).value(), options);
}

TEST(Adequacy, AnswersOfOneFormFittedInTheOtherAreUnfit) {
  for (const auto& [truth, fitted] : {std::pair(PsychometricForm::acuity, PsychometricForm::size),
                                      std::pair(PsychometricForm::size, PsychometricForm::acuity)}) {
    const std::vector<Level> levels = expected_counts(truth, 2, 0, 10, 2000);

    const Adequacy wrong = adequacy_of(levels, {fitted, 0.0, false});
    const Adequacy right = adequacy_of(levels, {truth, 0.0, false});

    EXPECT_THAT(wrong.findings, unfit_of_kind(FindingKind::deviance)) << to_string(fitted);
    EXPECT_FALSE(wrong.adequate());
    EXPECT_TRUE(right.adequate()) << reasons_unfit(right);
  }
}

TEST(Adequacy, LapsesThatAFitDoesNotAllowForAreUnfit) {
  const std::vector<Level> levels = expected_counts(PsychometricForm::size, 3.5, 0.05, 8, 80);

  EXPECT_THAT(adequacy_of(levels, {PsychometricForm::size, 0.0, false}).findings, unfit_of_kind(FindingKind::lapse));
  EXPECT_THAT(adequacy_of(levels, {PsychometricForm::size, std::nullopt, false}).findings,
              Not(of_kind(FindingKind::lapse)));
}

TEST(Adequacy, AMisfitThatDoesNotMoveTheThresholdIsFoundAndDoesNotWithholdIt) {
  // One wrong answer in three thousand at the largest sizes: significant beyond doubt, worth a tenth of a per cent.
  std::vector<Level> levels = expected_counts(PsychometricForm::size, 3.5, 0, 8, 100000);
  levels.back().correct -= 30;

  const Adequacy found = adequacy_of(levels, {PsychometricForm::size, 0.0, false});

  EXPECT_THAT(found.findings, of_kind(FindingKind::lapse));
  EXPECT_TRUE(found.adequate()) << reasons_unfit(found);
}

TEST(Adequacy, AShiftThatTheIntervalDoesNotHoldIsNotSaidToBeAllowedForByIt) {
  // Two million answers a size: an interval of 0.04 %, from which a curve of free shape departs by half a per cent.
  const std::vector<Level> levels{{1, 5e5, 2e6}, {1.5, 9e5, 2e6}, {2, 1.5e6, 2e6}, {3, 2e6, 2e6}};

  const Adequacy found = adequacy_of(levels, {PsychometricForm::size, 0.0, false});

  ASSERT_THAT(found.findings, of_kind(FindingKind::deviance));
  EXPECT_THAT(found.findings.front().sentence, ::testing::HasSubstr("outside the 95 % interval"));
}

TEST(Adequacy, ScatterBetweenClustersIsAllowedForWhereClustersAreNamed) {
  // Each presentation shifts its threshold by 30 %.
  std::vector<Level> levels =
      drawn({.sizes = 8, .trials_per_size = 8, .clusters = 48, .cluster_sd = 0.3}, RandomStream(3, "clusters"));

  const Adequacy named = adequacy_of(levels, {PsychometricForm::size, 0.0, false});
  for (Level& level : levels) level.cluster = -1;
  const Adequacy unnamed = adequacy_of(levels, {PsychometricForm::size, 0.0, false});

  EXPECT_THAT(named.findings, Not(of_kind(FindingKind::overdispersion)));
  EXPECT_THAT(unnamed.findings, unfit_of_kind(FindingKind::overdispersion));
}

TEST(Adequacy, CountsThatFollowTheFunctionTooCloselyAreUnderdispersedAndFit) {
  const Adequacy found =
      adequacy_of(expected_counts(PsychometricForm::size, 3.5, 0, 20, 1000), {PsychometricForm::size, 0.0, false});

  EXPECT_THAT(found.findings, of_kind(FindingKind::underdispersion));
  EXPECT_TRUE(found.adequate());
}

TEST(Adequacy, AThresholdOutsideTheTestedSizesIsUnfit) {
  std::vector<Level> levels = expected_counts(PsychometricForm::size, 2, 0, 10, 300);
  std::erase_if(levels, [](const Level& level) { return level.size > 0.9; });

  const Adequacy found = adequacy_of(levels, {PsychometricForm::size, 0.0, false});

  EXPECT_THAT(found.findings, unfit_of_kind(FindingKind::extrapolation));
}

TEST(Adequacy, AFunctionThatDoesNotRiseIsUnfitAndAPerfectStepOfFewTrialsIsNot) {
  const std::vector<Level> falling{{1, 80, 100, -1}, {2, 70, 100, -1}, {3, 60, 100, -1}};
  const std::vector<Level> step{{0.8, 1, 4, -1}, {0.9, 1, 4, -1}, {1.0, 3, 4, -1}, {1.1, 4, 4, -1}, {1.2, 4, 4, -1}};
  const std::vector<Level> steep{{0.9, 1000, 4000, -1}, {1.0, 3000, 4000, -1}, {1.02, 4000, 4000, -1}};

  EXPECT_THAT(adequacy_of(falling, {}).findings, unfit_of_kind(FindingKind::slope));
  EXPECT_THAT(adequacy_of(step, {}).findings, IsEmpty());
  EXPECT_THAT(adequacy_of(steep, {}).findings, of_kind(FindingKind::slope));
}

TodPoint good_point() {
  TodPoint point;
  point.set_delta_t_k = 1;
  point.levels = drawn({}, RandomStream(1, "point"));
  point.fit = fit_psychometric(point.levels, {.with_posterior = false}).value();
  return point;
}

TEST(Adequacy, TrialsAndDirectEstimateHaveToAgreeWithinTheErrorsOfBoth) {
  TodPoint point = good_point();
  point.direct_s75_se_mrad = 0.005 * *point.fit.threshold;
  const double half = std::log(*point.fit.ci95.high / *point.fit.ci95.low) / 2;
  // Two per cent for the form and three standard errors, of which one is half the interval over 1.96.
  const double allowed = 0.02 + 3 * std::hypot(half / 1.96, 0.005);

  point.direct_s75_mrad = *point.fit.threshold * std::exp(0.8 * allowed);
  EXPECT_THAT(adequacy(point, {}).findings, Not(of_kind(FindingKind::direct_estimate)));
  point.direct_s75_mrad = *point.fit.threshold * std::exp(1.3 * allowed);
  EXPECT_THAT(adequacy(point, {}).findings, unfit_of_kind(FindingKind::direct_estimate));
}

TEST(Adequacy, WhatFramesSayIsFoundEvenWithoutAThreshold) {
  TodPoint point;
  EXPECT_THAT(adequacy(point, {}).findings, IsEmpty());

  point.saturated_share = 0.01;
  point.noise_counts = 0.3;
  point.lag1_correlation = 0.8;
  const Adequacy found = adequacy(point, {});

  EXPECT_THAT(found.findings, unfit_of_kind(FindingKind::clipping));
  EXPECT_THAT(found.findings, of_kind(FindingKind::rounding));
  EXPECT_THAT(found.findings, of_kind(FindingKind::temporal_correlation));
  EXPECT_EQ(found.findings.size(), 3u);
}

TEST(Adequacy, AStepThatSomebodyWhoGuessesMayGiveIsUnfit) {
  const auto step = [](double each) {
    return std::vector<Level>{{1, 0, each, -1}, {1.5, each, each, -1}, {2.25, each, each, -1}};
  };
  ASSERT_TRUE(fit_psychometric(step(1), {})->threshold);
  ASSERT_TRUE(fit_psychometric(step(2), {})->threshold);

  // Every answer at the two largest of three sizes is right: (1/4)^2 or (1/4)^4, times three choices.
  EXPECT_NEAR(p_guessed(step(1)), 3.0 / 16, 1e-12);
  EXPECT_NEAR(p_guessed(step(2)), 3.0 / 256, 1e-12);
  EXPECT_THAT(adequacy_of(step(1), {}).findings, unfit_of_kind(FindingKind::slope));
  EXPECT_THAT(adequacy_of(step(2), {}).findings, Not(unfit_of_kind(FindingKind::slope)));
}

TEST(Adequacy, AnswersBelowChanceAndStepsThatDoNotFitAreUnfit) {
  const auto counts = [](double a, double b, double c, double d) {
    return std::vector<Level>{{1, a, 100, -1}, {2, b, 100, -1}, {3, c, 100, -1}, {4, d, 100, -1}};
  };
  const std::vector<Level> many{{1, 0, 1000, -1}, {2, 0, 1000, -1}, {3, 0, 1000, -1}, {4, 100, 100, -1}};

  EXPECT_THAT(adequacy_of(counts(0, 0, 100, 100), {}).findings, unfit_of_kind(FindingKind::deviance));
  EXPECT_THAT(adequacy_of(counts(2, 2, 90, 100), {}).findings, unfit_of_kind(FindingKind::deviance));
  EXPECT_THAT(adequacy_of(counts(0, 10, 70, 100), {}).findings, unfit_of_kind(FindingKind::deviance));
  EXPECT_THAT(adequacy_of(many, {}).findings, unfit_of_kind(FindingKind::deviance));
  ASSERT_EQ(fit_psychometric(counts(48, 24, 70, 100), {})->verdict, FitVerdict::step);
  EXPECT_THAT(adequacy_of(counts(48, 24, 70, 100), {}).findings, unfit_of_kind(FindingKind::deviance)) << "above";
  EXPECT_THAT(adequacy_of(counts(0, 0, 0, 0), {}).findings, unfit_of_kind(FindingKind::deviance)) << "no threshold";
  EXPECT_THAT(adequacy_of(counts(25, 25, 70, 100), {}).findings, IsEmpty());
}

TEST(Adequacy, AnswersOfASteepFunctionHardlyEverContradictIt) {
  constexpr int replicates = 500;
  int unfit = 0, deviant = 0, steps = 0;
  for (const double slope : {15.0, 30.0, 50.0, 1000.0}) {
    for (int r = 0; r < replicates; ++r) {
      const AdequacyDesign design{.sizes = 5 + r % 4, .trials_per_size = r % 2 == 0 ? 20 : 100, .slope = slope};
      const std::vector<Level> levels = drawn(
          design, RandomStream(11, "steep").sub(static_cast<std::uint64_t>(slope)).sub(static_cast<std::uint64_t>(r)));
      const FitOptions options{PsychometricForm::size, 0.0, false};
      const auto fit = fit_psychometric(levels, options).value();
      const Adequacy found = adequacy(levels, fit, options);
      steps += fit.verdict == FitVerdict::step ? 1 : 0;
      unfit += found.adequate() ? 0 : 1;
      deviant += std::ranges::count(found.findings, FindingKind::deviance, &AdequacyFinding::kind) > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(steps, replicates);
  EXPECT_LE(unfit, 4 * replicates / 100);
  EXPECT_LE(deviant, 4 * replicates / 100);
}

TEST(Adequacy, CorrelatedFramesWithholdAnIntervalOfIndependentAnswersOnly) {
  TodPoint point;
  point.levels = expected_counts(PsychometricForm::size, 4, 0, 9, 100);
  point.fit = fit_psychometric(point.levels, {}).value();
  point.lag1_correlation = 0.5;
  ASSERT_EQ(point.fit.interval, IntervalKind::independent);
  EXPECT_THAT(adequacy(point, {}).findings, unfit_of_kind(FindingKind::temporal_correlation));

  point.fit.interval = IntervalKind::clusters;
  EXPECT_THAT(adequacy(point, {}).findings, of_kind(FindingKind::temporal_correlation));
  EXPECT_TRUE(adequacy(point, {}).adequate());
}

TEST(Adequacy, GivesTheSameFindingsWhateverTheUnitAndOrderOfTheRows) {
  std::vector<Level> levels =
      drawn({.trials_per_size = 800, .truth = PsychometricForm::acuity, .lapse = 0.02}, RandomStream(2, "unit"));
  const Adequacy before = adequacy_of(levels, {PsychometricForm::size, 0.0, false});
  std::reverse(levels.begin(), levels.end());
  for (Level& level : levels) level.size *= 1000;
  const Adequacy after = adequacy_of(levels, {PsychometricForm::size, 0.0, false});

  ASSERT_EQ(before.findings.size(), after.findings.size());
  ASSERT_FALSE(before.findings.empty());
  for (std::size_t i = 0; i < before.findings.size(); ++i) {
    EXPECT_EQ(before.findings[i].kind, after.findings[i].kind);
    EXPECT_NEAR(*before.findings[i].value, *after.findings[i].value, 1e-6 * *before.findings[i].value);
  }
}

// A statistic of n draws of 1 +- sqrt(2 / nu) has a standard error of its mean of that over sqrt(n).
TEST(Dispersion, OfRowsOfOneSizeHasTheMeanAndVarianceOfChance) {
  double sum = 0, squares = 0;
  constexpr int replicates = 2000;
  double freedom = 0;
  for (int r = 0; r < replicates; ++r) {
    const auto levels = drawn({.sizes = 5, .trials_per_size = 3, .rows = 12},
                              RandomStream(5, "rows").sub(static_cast<std::uint64_t>(r)));
    const auto fit = fit_psychometric(levels, {.with_posterior = false});
    if (fit->verdict != FitVerdict::ok) continue;
    const PooledCounts counts = pool(levels);
    const Dispersion found =
        dispersions(model_residuals(counts, PsychometricForm::size,
                                    {counts.relative(*fit->threshold), std::log(*fit->slope), 0}, {true, true, false}),
                    levels, {}, 0)
            .more;
    sum += found.ratio;
    squares += found.ratio * found.ratio;
    freedom += found.degrees_of_freedom / replicates;
  }
  const double mean = sum / replicates, variance = squares / replicates - mean * mean;

  EXPECT_GT(freedom, 45);  // 55 rows beyond one for each size, sizes with hardly a wrong answer count for little
  EXPECT_NEAR(mean, 1, 4 * std::sqrt(2 / freedom / replicates) + 0.01);
  EXPECT_NEAR(variance, 2 / freedom, 0.25 * 2 / freedom);
}

// Short form of the study: with 150 replicates a rate of 1 % gives more than 7 findings once in five thousand.
TEST(Adequacy, RightModelsAreAdequate) {
  constexpr int replicates = 150;
  for (const AdequacyDesign& design : std::vector<AdequacyDesign>{
           {.name = "8 x 80"}, {.name = "24 clusters", .trials_per_size = 4, .clusters = 24, .cluster_sd = 0.08}}) {
    const auto shares = finding_shares(design, replicates, 12);
    for (const auto& [kind, share] : shares.found)
      EXPECT_LE(share * replicates, 7) << design.name << ": " << to_string(kind);
  }
}

TEST(Adequacy, OfAFitByTheTwinFindsWhatIsWrongAndSeldomWhatIsRight) {
#ifdef TODBENCH_SANITIZED
  constexpr int runs = 30;  // 0.13 s each
#else
  constexpr int runs = 150;
#endif
  int alarms = 0, lapses = 0, twists = 0;
  for (int run = 1; run <= runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto unfit = [](const TodPoint& point) { return !adequacy(point, {}).adequate(); };
    alarms += unfit(point_by_twin(seed, 0, 0)) ? 1 : 0;
    const Adequacy lapsing = adequacy(point_by_twin(seed, 0.08, 0), {});
    const Adequacy twisted = adequacy(point_by_twin(seed, 0, 1), {});
    lapses += lapsing.findings.empty() ? 0 : 1;
    twists += twisted.findings.empty() ? 0 : 1;
  }
  // 0.5 % for a lapse, 0.3 % for scatter, 1 % for another slope that would move the threshold.
  EXPECT_LE(alarms, 0.018 * runs + 3.5 * std::sqrt(0.018 * runs));
  EXPECT_GT(lapses, 0.5 * runs);
  EXPECT_GT(twists, 0.8 * runs);
}

}  // namespace
}  // namespace todbench
