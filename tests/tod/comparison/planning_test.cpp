// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/comparison/planning.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/tod/comparison/planning_reference.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {
namespace {

using test::least_se_ln_threshold;
using test::se_for_equivalence;

std::vector<Level> ten_sizes(double trials_each, double first, double span) {
  std::vector<Level> out;
  for (int i = 0; i < 10; ++i) out.push_back({first * std::pow(span, i / 9.0), 0, trials_each});
  return out;
}

TEST(ExpectedFit, FindsTheFunctionThatItWasMadeFrom) {
  const auto design = design_at(ten_sizes(16, 1, 4), PsychometricForm::size, 1.9, 3.2, 0);

  const auto fit = expected_fit(design, {});

  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->threshold, 1.9, 1e-6);
  EXPECT_NEAR(fit->slope, 3.2, 1e-5);
  EXPECT_DOUBLE_EQ(fit->trials, 160);
}

TEST(ExpectedFit, HasTheStandardErrorOfTheFisherInformation) {
  // Independent: numerical derivatives of psi, information summed by hand, 2 x 2 inverse.
  const double t = 1.9, b = 3.2;
  const auto levels = ten_sizes(16, 1, 4);
  double tt = 0, tq = 0, qq = 0;
  for (const Level& level : levels) {
    const auto psi = [&](double dt, double dq) {
      return psychometric(PsychometricForm::size, level.size, t * std::exp(dt), b * std::exp(dq), 0);
    };
    const double h = 1e-5;
    const double by_t = (psi(h, 0) - psi(-h, 0)) / (2 * h), by_q = (psi(0, h) - psi(0, -h)) / (2 * h);
    const double weight = level.total / (psi(0, 0) * (1 - psi(0, 0)));
    tt += weight * by_t * by_t;
    tq += weight * by_t * by_q;
    qq += weight * by_q * by_q;
  }
  const double expected = std::sqrt(qq / (tt * qq - tq * tq));

  const auto fit = expected_fit(design_at(levels, PsychometricForm::size, t, b, 0), {});

  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->se_ln_threshold / expected, 1, 1e-4);
}

TEST(ExpectedFit, RefusesADesignThatCannotShowAThreshold) {
  const auto far_too_large = design_at(ten_sizes(16, 100, 4), PsychometricForm::size, 1, 3.5, 0);

  const auto fit = expected_fit(far_too_large, {});

  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::invalid_input);
  EXPECT_NE(fit.error().message.find("below_range"), std::string::npos) << fit.error().message;
}

TEST(LeastStandardError, IsTheCramerRaoBoundWithEveryTrialAtTheThreshold) {
  // 45.05 % / sqrt(N) at slope 3.5.
  EXPECT_NEAR(least_se_ln_threshold(1, 3.5), 0.4505, 5e-5);
  EXPECT_NEAR(least_se_ln_threshold(160, 7), 0.4505 / 2 / std::sqrt(160), 1e-5);
}

TEST(LeastStandardError, IsNotBeatenByADesignOfManySizes) {
  for (const double span : {1.3, 2.0, 4.0, 10.0}) {
    const auto fit =
        expected_fit(design_at(ten_sizes(16, 1 / std::sqrt(span), span), PsychometricForm::size, 1, 3.5, 0), {});
    ASSERT_TRUE(fit);
    EXPECT_GT(fit->se_ln_threshold, least_se_ln_threshold(160, 3.5)) << span;
  }
}

TEST(EquivalencePower, IsWhatTheStandardErrorForItPromises) {
  for (const double power : {0.05, 0.5, 0.8, 0.95, 0.999})
    EXPECT_NEAR(equivalence_power(se_for_equivalence(10, power), 10, 0), power, 1e-12);
}

TEST(EquivalencePower, IsFivePercentOnTheMarginItself) {
  // The other one-sided test is then certain to pass.
  EXPECT_NEAR(equivalence_power(0.001, 10, std::log(1.1)), 0.05, 1e-12);
}

TEST(EquivalencePower, IsZeroWhereTheIntervalIsWiderThanTheMargin) {
  EXPECT_EQ(equivalence_power(0.06, 10, 0), 0);  // 1.645 x 0.06 > ln 1.1
}

TEST(ComparisonOutlook, MultipliesTrialsUntilAllContrastsTogetherReachEightyPercent) {
  const std::vector<PlannedComparison> contrasts{
      {.delta_t_k = 10, .se_ln_a = 0.03, .se_ln_b = 0.02, .trials_a = 400, .trials_b = 800},
      {.delta_t_k = 1, .se_ln_a = 0.04, .se_ln_b = 0.02, .trials_a = 400, .trials_b = 800}};

  const auto outlook = comparison_outlook(contrasts, 10);

  EXPECT_FALSE(outlook.reaches_80_percent());
  double power = 1;
  for (auto contrast : contrasts)
    power *= equivalence_power(contrast.se_ln_ratio() / std::sqrt(outlook.trials_factor), 10, 0);
  EXPECT_NEAR(power, 0.8, 1e-6);
  EXPECT_EQ(outlook.trials_needed_a, std::ceil(400 * outlook.trials_factor));
}

TEST(ComparisonOutlook, SaysHowFarTrialsCouldBeReducedWhereThePlanSuffices) {
  const PlannedComparison contrast{
      .delta_t_k = 1, .se_ln_a = 0.01, .se_ln_b = 0.01, .trials_a = 5000, .trials_b = 5000};

  const auto outlook = comparison_outlook(std::span(&contrast, 1), 10);

  EXPECT_TRUE(outlook.reaches_80_percent());
  EXPECT_LT(outlook.trials_factor, 1);
  EXPECT_NEAR(outlook.trials_factor, std::pow(contrast.se_ln_ratio() / se_for_equivalence(10, 0.8), 2), 1e-6);
}

/// The promise against the tests that are really made, on simulated answers.
TEST(ComparisonOutlook, PredictsHowOftenTheComparisonOfSimulatedAnswersFindsEquivalence) {
  const auto totals = ten_sizes(60, 1 / std::sqrt(2.0), 2);
  const double margin_percent = 10, slope = 3.5;
  const auto expected = expected_fit(design_at(totals, PsychometricForm::size, 1, slope, 0), {});
  ASSERT_TRUE(expected);
  const PlannedComparison contrast{.delta_t_k = 1,
                                   .se_ln_a = expected->se_ln_threshold,
                                   .se_ln_b = expected->se_ln_threshold,
                                   .trials_a = 600,
                                   .trials_b = 600};
  const double promised = comparison_outlook(std::span(&contrast, 1), margin_percent).power;
  constexpr int runs = 400;

  std::mt19937_64 generator(20);
  const auto answers = [&] {
    std::vector<Level> levels = totals;
    for (Level& level : levels) {
      std::binomial_distribution<int> right(static_cast<int>(level.total),
                                            psychometric(PsychometricForm::size, level.size, 1, slope, 0));
      level.correct = right(generator);
    }
    return levels;
  };
  int found = 0;
  for (int run = 0; run < runs; ++run) {
    const auto test = test_thresholds(answers(), answers(), SlopeModel::separate, margin_percent, {});
    ASSERT_TRUE(test);
    if (test->p_equivalence < 0.05) ++found;
  }

  // Four standard errors of the share, plus 3 % for normal theory at these numbers.
  ASSERT_GT(promised, 0.3);
  ASSERT_LT(promised, 0.95);
  EXPECT_NEAR(found / static_cast<double>(runs), promised, 4 * std::sqrt(promised * (1 - promised) / runs) + 0.03);
}

}  // namespace
}  // namespace todbench
