// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of thresholds against a plain search, and the verdicts on whole curves.
#include "tod/comparison/comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/tod/psychometric/psychometric_support.h"

namespace todbench {
namespace {

using nlohmann::json;
using testing::geometric;
using testing::reference_cases;

// The place of the maximum of a function with one peak in an interval, by golden sections.
template <typename Function>
double peak(const Function& function, double low, double high) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  for (int k = 0; k < 70; ++k) {
    const double x = high - ratio * (high - low), y = low + ratio * (high - low);
    if (function(x) < function(y)) {
      low = x;
    } else {
      high = y;
    }
  }
  return (low + high) / 2;
}

double upper_normal_tail(double x) {
  return std::erfc(x / std::sqrt(2.0)) / 2;
}

struct PlainPair {
  std::vector<Level> a, b;

  [[nodiscard]] double ll(const std::vector<Level>& levels, double t, double q) const {
    return testing::plain_log_likelihood(levels, PsychometricForm::size, t, std::exp(q), 0);
  }
  [[nodiscard]] double best_t(const std::vector<Level>& levels, double q) const {
    return peak([&](double t) { return ll(levels, t, q); }, -0.5, 0.5);
  }
  [[nodiscard]] double best_q(const std::vector<Level>& levels, double t) const {
    return peak([&](double q) { return ll(levels, t, q); }, 0.0, 3.0);
  }
  [[nodiscard]] double over_q(const std::vector<Level>& levels, double t) const {
    return ll(levels, t, best_q(levels, t));
  }
  [[nodiscard]] double apart(double q) const { return ll(a, best_t(a, q), q) + ll(b, best_t(b, q), q); }
  [[nodiscard]] double together(double q) const { return ll(a, common_t(q), q) + ll(b, common_t(q), q); }
  [[nodiscard]] double common_t(double q) const {
    return peak([&](double t) { return ll(a, t, q) + ll(b, t, q); }, -0.5, 0.5);
  }
};

PlainPair reference_pair() {
  const json reference = reference_cases();
  return {testing::levels_of_case(reference, "sim_unsorted"), testing::levels_of_case(reference, "sim_7x30")};
}

TEST(Comparison, SharedSlopeTestAgreesWithAPlainSearch) {
  const PlainPair pair = reference_pair();
  const double q1 = peak([&](double q) { return pair.apart(q); }, 0.5, 2.5);
  const double q0 = peak([&](double q) { return pair.together(q); }, 0.5, 2.5);
  const double ta = pair.best_t(pair.a, q1), tb = pair.best_t(pair.b, q1);

  const auto test = test_thresholds(pair.a, pair.b, SlopeModel::shared, 10, {});

  ASSERT_TRUE(test) << test.error().message;
  // Golden sections find a maximum to the root of rounding (1e-8 of the place), hence its height to rounding.
  EXPECT_NEAR(test->ll_separate, pair.apart(q1), 1e-10);
  EXPECT_NEAR(test->ll_common, pair.together(q0), 1e-10);
  EXPECT_NEAR(test->lr, 2 * (pair.apart(q1) - pair.together(q0)), 1e-9);
  EXPECT_NEAR(test->ln_ratio, ta - tb, 1e-6);
  EXPECT_NEAR(test->p_difference, std::erfc(std::sqrt(test->lr / 2)), 1e-12);
  EXPECT_NEAR(test->p_equivalence, upper_normal_tail((std::log(1.1) - std::abs(test->ln_ratio)) / test->se_ln_ratio),
              1e-12);
  // Standard error from the curvature of the likelihood over the difference d of thresholds, maximised over the rest:
  // second difference with step 0.02, whose error is a fourth derivative times h^2 / 12, below 1 %.
  const auto at_difference = [&](double d) {
    const auto over_t = [&](double q) {
      const double t = peak([&](double x) { return pair.ll(pair.a, x + d, q) + pair.ll(pair.b, x, q); }, -0.5, 0.5);
      return pair.ll(pair.a, t + d, q) + pair.ll(pair.b, t, q);
    };
    return over_t(peak(over_t, 0.5, 2.5));
  };
  const double h = 0.02, d = test->ln_ratio;
  const double curvature = (at_difference(d + h) - 2 * at_difference(d) + at_difference(d - h)) / (h * h);
  EXPECT_NEAR(test->se_ln_ratio, 1 / std::sqrt(-curvature), 0.01 * test->se_ln_ratio);
}

TEST(Comparison, SeparateSlopesTestAgreesWithAPlainSearch) {
  const PlainPair pair = reference_pair();
  const double ta = peak([&](double t) { return pair.over_q(pair.a, t); }, -0.3, 0.3);
  const double tb = peak([&](double t) { return pair.over_q(pair.b, t); }, -0.3, 0.3);
  const auto sum = [&](double t) { return pair.over_q(pair.a, t) + pair.over_q(pair.b, t); };
  const double separate = pair.over_q(pair.a, ta) + pair.over_q(pair.b, tb), common = sum(peak(sum, -0.3, 0.3));

  const auto test = test_thresholds(pair.a, pair.b, SlopeModel::separate, 10, {});
  const auto a = fit_psychometric(pair.a, {}), b = fit_psychometric(pair.b, {});

  ASSERT_TRUE(test && a && b);
  EXPECT_NEAR(test->ll_separate, separate, 1e-10);
  EXPECT_NEAR(test->ll_common, common, 1e-10);
  EXPECT_NEAR(test->ln_ratio, ta - tb, 1e-6);
  EXPECT_NEAR(test->se_ln_ratio, std::hypot(a->se_ln_threshold.value(), b->se_ln_threshold.value()), 1e-12);
}

std::vector<Level> counts(double threshold, double slope, double total) {
  std::vector<Level> levels;
  for (const double size : geometric(0.5, 2, 9))
    levels.push_back(
        {size, std::round(total * psychometric(PsychometricForm::size, size, threshold, slope, 0)), total, -1});
  return levels;
}

TEST(Comparison, ExchangingTheDataSetsChangesOnlyTheSignOfTheRatio) {
  const auto a = counts(1, 3, 40), b = counts(1.15, 5, 30);
  for (const SlopeModel slopes : {SlopeModel::shared, SlopeModel::separate}) {
    for (const std::optional<double>& lapse : {std::optional(0.0), std::optional(0.02), std::optional<double>()}) {
      const auto ab = test_thresholds(a, b, slopes, 10, {.fixed_lapse = lapse});
      const auto ba = test_thresholds(b, a, slopes, 10, {.fixed_lapse = lapse});

      ASSERT_TRUE(ab && ba);
      EXPECT_NEAR(ab->lr, ba->lr, 1e-9);
      EXPECT_NEAR(ab->ln_ratio, -ba->ln_ratio, 1e-9);
      EXPECT_NEAR(ab->p_equivalence, ba->p_equivalence, 1e-8);
      EXPECT_GT(ab->lr, 3.84);  // 15 % at this many trials
    }
  }
}

TEST(Comparison, EqualDataGiveNoDifference) {
  const auto a = counts(1, 3, 40);

  const auto test = test_thresholds(a, a, SlopeModel::separate, 10, {});

  ASSERT_TRUE(test);
  EXPECT_NEAR(test->lr, 0, 1e-10);
  EXPECT_NEAR(test->p_difference, 1, 1e-4);
  EXPECT_EQ(test->ln_ratio, 0);
}

TEST(Comparison, RefusesADataSetWithoutAThreshold) {
  const std::vector<Level> right{{1, 20, 20}, {2, 20, 20}};

  const auto test = test_thresholds(counts(1, 3, 40), right, SlopeModel::shared, 10, {});

  ASSERT_FALSE(test);
  EXPECT_EQ(test.error().code, ErrorCode::invalid_input);
  EXPECT_EQ(test.error().message, "data set B has no threshold: below_range");
}

TEST(Comparison, RefusesAMarginThatIsNotPositive) {
  const auto a = counts(1, 3, 40);

  EXPECT_FALSE(test_thresholds(a, a, SlopeModel::shared, 0, {}));
  EXPECT_FALSE(test_thresholds(a, a, SlopeModel::shared, NAN, {}));
}

TodPoint point(double contrast, const std::vector<Level>& levels) {
  TodPoint p;
  p.set_delta_t_k = contrast;
  p.delta_t_k = 0.95 * contrast;
  p.levels = levels;
  p.fit = *fit_psychometric(levels, {.with_posterior = false});
  return p;
}

TodCurve curve(const std::vector<TodPoint>& points) {
  return {"observer", "sensor", points};
}

TEST(Comparison, ManyTrialsOfEqualThresholdsAreEquivalent) {
  const auto a = curve({point(2, counts(1, 3, 1000))}), b = curve({point(2.005, counts(1.01, 3.2, 1000))});

  const auto comparison = compare(a, b, {});

  ASSERT_TRUE(comparison);
  ASSERT_EQ(comparison->points.size(), 1u);
  const ComparisonPoint& p = comparison->points[0];
  EXPECT_EQ(p.verdict, ComparisonVerdict::equivalent);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::equivalent);
  EXPECT_NEAR(p.ratio.value(), 1.01, 1e-3);  // acuity of A over B is S75 of B over A; counts are rounded to 1e-3
  EXPECT_LT(p.p_equivalence.value(), 0.05);
  EXPECT_EQ(p.delta_t_a_k, 0.95 * 2);
}

TEST(Comparison, ByTheFunctionOfATwinAndByAWeibullFunctionIsInconclusiveThere) {
  TodPoint shaped = point(2, counts(1, 3, 1000));
  shaped.fit.twin_shape.emplace();
  const auto b = curve({point(2, counts(1.01, 3.2, 1000)), point(0.5, counts(2, 3, 1000))});

  const auto comparison = compare(curve({shaped, point(0.5, counts(2.01, 3.1, 1000))}), b, {});

  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->points[0].verdict, ComparisonVerdict::inconclusive);
  EXPECT_EQ(comparison->points[1].verdict, ComparisonVerdict::equivalent);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::inconclusive);
  ASSERT_EQ(comparison->adequacy->findings.size(), 1u);
  EXPECT_EQ(comparison->adequacy->findings[0].kind, FindingKind::identity);
}

TEST(Comparison, RatioIntervalsJoinBothIntervalsOnTheLogScale) {
  const auto a = point(2, counts(1, 3, 30)), b = point(2, counts(1.1, 5, 20));

  const auto comparison = compare(curve({a}), curve({b}), {});

  ASSERT_TRUE(comparison);
  const ComparisonPoint& p = comparison->points[0];
  const double d = std::log(*b.fit.threshold / *a.fit.threshold);
  const auto squared = [](double x) { return x * x; };
  const double low = d - std::sqrt(squared(std::log(*b.fit.threshold / *b.fit.ci95.low)) +
                                   squared(std::log(*a.fit.ci95.high / *a.fit.threshold)));
  const double high = d + std::sqrt(squared(std::log(*b.fit.ci90.high / *b.fit.threshold)) +
                                    squared(std::log(*a.fit.threshold / *a.fit.ci90.low)));
  EXPECT_NEAR(std::log(p.ratio_ci95.low.value()), low, 1e-12);
  EXPECT_NEAR(std::log(p.ratio_ci90.high.value()), high, 1e-12);
  EXPECT_LT(*p.ratio_ci95.low, *p.ratio_ci90.low);
  EXPECT_GT(*p.ratio_ci95.high, *p.ratio_ci90.high);
}

TEST(Comparison, EquivalenceIsSignificantExactlyWhereTheIntervalLiesWithinTheMargin) {
  // Trials and true ratios on both sides of what shows equivalence within 10 %.
  int equivalent = 0, others = 0;
  for (const int trials : {100, 200, 300, 400, 600}) {
    for (double ratio = 0.9; ratio <= 1.1; ratio += 0.01) {
      const auto comparison =
          compare(curve({point(2, counts(1, 3, trials))}), curve({point(2, counts(ratio, 4, trials))}), {});
      ASSERT_TRUE(comparison);
      const ComparisonPoint& p = comparison->points[0];
      const bool within = *p.ratio_ci90.low >= 1 / 1.1 && *p.ratio_ci90.high <= 1.1;
      EXPECT_EQ(p.p_equivalence.value() <= 0.05, within) << trials << " trials, ratio " << ratio;
      ++(within ? equivalent : others);
    }
  }
  EXPECT_GT(equivalent, 20);
  EXPECT_GT(others, 20);
}

TEST(Comparison, EquivalenceAgreesWithTheStandardErrorWhereThereAreManyTrials) {
  const auto a = point(2, counts(1, 3, 2000)), b = point(2, counts(1.08, 3, 2000));
  const auto comparison = compare(curve({a}), curve({b}), {});

  ASSERT_TRUE(comparison);
  const double ln_ratio = std::log(*b.fit.threshold / *a.fit.threshold);
  const double wald = upper_normal_tail((std::log(1.1) - std::abs(ln_ratio)) /
                                        std::hypot(*a.fit.se_ln_threshold, *b.fit.se_ln_threshold));
  // Profile and Wald intervals of 16 000 trials differ by less than 2 %.
  EXPECT_NEAR(comparison->points[0].p_equivalence.value() / wald, 1, 0.1);
}

TEST(Comparison, FewTrialsOfEqualThresholdsAreInconclusive) {
  const auto comparison = compare(curve({point(2, counts(1, 3, 16))}), curve({point(2, counts(1.02, 3, 16))}), {});

  ASSERT_TRUE(comparison);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::inconclusive);
  EXPECT_GT(comparison->points[0].p_difference.value(), 0.05);
}

TEST(Comparison, OneDifferentContrastMakesTheCurvesDifferent) {
  const auto a = curve({point(10, counts(1, 3, 1000)), point(2, counts(1, 3, 300)), point(5, counts(1, 3, 300))});
  const auto b = curve({point(10, counts(1, 3, 1000)), point(2, counts(1.3, 3, 300))});

  const auto comparison = compare(a, b, {});

  ASSERT_TRUE(comparison);
  ASSERT_EQ(comparison->points.size(), 2u);
  EXPECT_EQ(comparison->points[0].verdict, ComparisonVerdict::equivalent);
  EXPECT_EQ(comparison->points[1].verdict, ComparisonVerdict::different);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::different);
}

TEST(Comparison, EquivalentWinsOverAProvenButSmallDifference) {
  const auto comparison =
      compare(curve({point(2, counts(1, 3, 100000))}), curve({point(2, counts(1.03, 3, 100000))}), {});

  ASSERT_TRUE(comparison);
  EXPECT_LT(comparison->points[0].p_difference.value(), 0.001);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::equivalent);
}

TEST(Comparison, AMissingThresholdLeavesTheRatioOutAndIsInconclusive) {
  const auto comparison =
      compare(curve({point(2, counts(1, 3, 300))}), curve({point(2, {{1, 20, 20}, {2, 20, 20}})}), {});

  ASSERT_TRUE(comparison);
  EXPECT_FALSE(comparison->points[0].ratio || comparison->points[0].p_difference ||
               comparison->points[0].p_equivalence);
  EXPECT_FALSE(comparison->points[0].ratio_ci95.low || comparison->points[0].ratio_ci90.high);
  EXPECT_EQ(comparison->verdict, ComparisonVerdict::inconclusive);
}

TEST(Comparison, AThresholdFarOutsideTheSizesGivesNoRatio) {
  const std::vector<Level> near_chance{{0.7875, 1, 2}, {0.95, 0, 2}, {1.14, 0, 2},    {1.38, 1, 2}, {1.66, 2, 2},
                                       {2, 0, 2},      {2.41, 1, 2}, {2.90625, 1, 2}, {3.5, 1, 2},  {4.21875, 0, 2}};
  const TodPoint far = point(1, near_chance);
  ASSERT_GT(far.fit.threshold.value(), 1000);

  const auto comparison = compare(curve({point(1, counts(1, 3, 40))}), curve({far}), {});

  ASSERT_TRUE(comparison);
  EXPECT_FALSE(comparison->points[0].ratio);
  EXPECT_EQ(comparison->points[0].verdict, ComparisonVerdict::inconclusive);
}

TEST(Comparison, ClusteringWeakensTheEvidence) {
  // Six clusters of which three always do better: the counts of each size are the same as without clusters.
  const auto clustered = [](double threshold) {
    std::vector<Level> levels;
    for (int c = 0; c < 6; ++c) {
      for (Level level : counts(threshold * (c < 3 ? 0.8 : 1.25), 3, 40)) {
        level.cluster = c;
        levels.push_back(level);
      }
    }
    return levels;
  };
  const auto plain = [&clustered](double threshold) {
    auto levels = clustered(threshold);
    for (Level& level : levels) level.cluster = -1;
    return levels;
  };

  const auto with = compare(curve({point(2, clustered(1))}), curve({point(2, clustered(1.15))}), {});
  const auto without = compare(curve({point(2, plain(1))}), curve({point(2, plain(1.15))}), {});

  ASSERT_TRUE(with && without);
  EXPECT_EQ(without->verdict, ComparisonVerdict::different);
  EXPECT_EQ(with->verdict, ComparisonVerdict::inconclusive);
  EXPECT_GT(*with->points[0].p_difference, 10 * *without->points[0].p_difference);
  EXPECT_LT(*with->points[0].ratio_ci95.low, *without->points[0].ratio_ci95.low);
  EXPECT_NEAR(*with->points[0].ratio, *without->points[0].ratio, 1e-9);
}

TEST(Comparison, RefusesCurvesOfDifferentObserversOrWithoutACommonContrast) {
  const auto a = curve({point(2, counts(1, 3, 40))});
  auto other = a;
  other.observer = "somebody else";

  EXPECT_EQ(compare(a, other, {}).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(compare(a, curve({point(2.02, counts(1, 3, 40))}), {}).error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
