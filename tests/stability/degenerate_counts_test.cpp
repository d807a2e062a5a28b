// SPDX-License-Identifier: GPL-3.0-or-later
// Counts without a maximum of the likelihood: the answer is a verdict and, where one exists, a limit known in closed
// form.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stability/fifty_digits.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {
namespace {

using testing::Digits;

/// 2.7055 / 2: the drop of a one-sided 95 % limit.
const double half_drop = 2.705543454095404 / 2;
constexpr double steepest = 50;

bool finite_where_given(const PsychometricFit& fit) {
  for (const auto& value : {fit.threshold, fit.slope, fit.ci95.low, fit.ci95.high, fit.ci90.low, fit.ci90.high,
                            fit.log_likelihood, fit.deviance, fit.se_ln_threshold}) {
    if (value && !std::isfinite(*value)) return false;
  }
  return !fit.posterior || (std::isfinite(fit.posterior->low) && std::isfinite(fit.posterior->median) &&
                            std::isfinite(fit.posterior->high) && fit.posterior->low < fit.posterior->high);
}

// Hard: the supremum lies at threshold 0. One level, all n correct: the upper limit is the largest threshold whose
// likelihood has fallen by no more than half_drop, with the steepest slope (b = 50):
// n ln psi = -half_drop, psi = 1 - 0.75 exp(-ln3 exp(50 (ln x - t))), solved for t.
TEST(DegenerateCounts, AllCorrectHaveTheUpperLimitOfTheSteepestCurve) {
  for (const double n : {10.0, 100.0, 1e6}) {
    const std::vector<Level> levels{{1.7, n, n, -1}};
    const Digits psi = exp(Digits(-half_drop / n));
    const double expected = static_cast<double>(log(Digits(1.7)) - testing::exponent_at(psi) / steepest);

    const auto fit = fit_psychometric(levels, {});

    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->verdict, FitVerdict::below_range);
    EXPECT_FALSE(fit->threshold || fit->ci95.low);
    ASSERT_TRUE(fit->ci95.high);
    // The limit is a root search to 1e-9 in ln; 1 - psi loses 1e-16 n of itself.
    EXPECT_NEAR(std::log(*fit->ci95.high), expected, 1e-7) << n;
    EXPECT_TRUE(finite_where_given(*fit));
  }
}

// Hard: the supremum lies at an infinite threshold. All n wrong: n (ln 0.75 - z) falls by half_drop at
// z = half_drop / n, ln z = ln ln3 + 50 (ln x - t).
TEST(DegenerateCounts, NoneCorrectHaveTheLowerLimitOfTheSteepestCurve) {
  for (const double n : {10.0, 100.0, 1e6}) {
    const std::vector<Level> levels{{1.7, 0, n, -1}};
    const double expected = std::log(1.7) - std::log(half_drop / n / std::log(3.0)) / steepest;

    const auto fit = fit_psychometric(levels, {});

    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->verdict, FitVerdict::above_range);
    EXPECT_FALSE(fit->threshold || fit->ci95.high);
    ASSERT_TRUE(fit->ci95.low);
    EXPECT_NEAR(std::log(*fit->ci95.low), expected, 1e-7) << n;
    EXPECT_TRUE(finite_where_given(*fit));
  }
}

// Hard: one number for two parameters. The ridge of all curves through the point is the maximum.
TEST(DegenerateCounts, OneLevelHasNoSlopeAndNoPointEstimate) {
  const auto fit = fit_psychometric(std::vector<Level>{{1.7, 15, 20, -1}}, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::slope_unidentifiable);
  EXPECT_FALSE(fit->threshold || fit->slope);
  EXPECT_TRUE(finite_where_given(*fit));
}

// Hard: perfect separation: the likelihood rises for ever with the slope. Chance below 1, all correct from 2 on: any
// step between them is equally likely, so no threshold, but the interval ends near the two sizes: at the steepest slope
// a step beyond the larger size would need its 20 right answers by less than half_drop.
TEST(DegenerateCounts, PerfectSeparationIsAStepWithAnIntervalAroundTheGap) {
  const auto fit =
      fit_psychometric(std::vector<Level>{{0.5, 5, 20, -1}, {1, 5, 20, -1}, {2, 20, 20, -1}, {4, 20, 20, -1}}, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::step);
  EXPECT_FALSE(fit->slope);
  ASSERT_TRUE(fit->ci95.low && fit->ci95.high);
  EXPECT_GT(*fit->ci95.low, 0.8);
  EXPECT_LT(*fit->ci95.low, 1.1);
  EXPECT_GT(*fit->ci95.high, 1.8);
  EXPECT_LT(*fit->ci95.high, 2.1);
  EXPECT_TRUE(finite_where_given(*fit));
}

// Hard: the best curve of the family is the flattest; any threshold would be a number made up.
TEST(DegenerateCounts, DecreasingAnswersHaveNoThreshold) {
  const auto fit =
      fit_psychometric(std::vector<Level>{{0.5, 18, 20, -1}, {1, 15, 20, -1}, {2, 12, 20, -1}, {4, 9, 20, -1}}, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::flat_or_decreasing);
  EXPECT_FALSE(fit->usable());
  EXPECT_TRUE(finite_where_given(*fit));
}

// Every small table of counts at three sizes, six decades apart and close together: nothing made is a NaN and
// an interval never excludes its own estimate.
TEST(DegenerateCounts, EverySmallTableOfCountsGivesFiniteNumbers) {
  for (const double spread : {1.001, 2.0, 1e6}) {
    for (int code = 0; code < 64; ++code) {
      const std::vector<Level> levels{
          {1 / spread, code % 4 * 1.0, 3, -1}, {1, code / 4 % 4 * 1.0, 3, -1}, {spread, code / 16 * 1.0, 3, -1}};
      for (const auto& lapse : {std::optional(0.0), std::optional<double>()}) {
        for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
          const auto fit = fit_psychometric(levels, {.form = form, .fixed_lapse = lapse});

          ASSERT_TRUE(fit);
          EXPECT_TRUE(finite_where_given(*fit)) << spread << " " << code;
          if (fit->threshold && fit->ci95.low) {
            EXPECT_LE(*fit->ci95.low, *fit->threshold * (1 + 1e-9));
          }
          if (fit->threshold && fit->ci95.high) {
            EXPECT_GE(*fit->ci95.high, *fit->threshold * (1 - 1e-9));
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace todbench
