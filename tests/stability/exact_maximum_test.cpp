// SPDX-License-Identifier: GPL-3.0-or-later
// Data whose maximum is well defined but hard to reach in double precision, against 50-digit arithmetic.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/stability/fifty_digits.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {
namespace {

using testing::Digits;
using testing::exponent_at;
using testing::maximum_50;

/// Counts nearest to expectation: they put the maximum at the truth within rounding.
std::vector<Level> expected_counts(const std::vector<double>& sizes, double trials, double threshold, double slope,
                                   double lapse) {
  std::vector<Level> levels;
  for (const double size : sizes) {
    const double psi = psychometric(PsychometricForm::size, size, threshold, slope, lapse);
    levels.push_back({size, std::round(trials * psi), trials, -1});
  }
  return levels;
}

/// The fit's own convergence bound: a gradient of 1e-8 of the information moves a parameter by less than 1e-8. It gets
/// much nearer; 1e-9 leaves a factor of ten to that bound.
void expect_the_maximum(const std::vector<Level>& levels, double lapse, double tolerance = 1e-9) {
  const auto fit = fit_psychometric(levels, {.fixed_lapse = lapse, .with_posterior = false});
  ASSERT_TRUE(fit);
  ASSERT_TRUE(fit->threshold && fit->slope && fit->log_likelihood) << to_string(fit->verdict);

  const auto exact = maximum_50(levels, std::log(*fit->threshold), std::log(*fit->slope), lapse);

  ASSERT_TRUE(exact.converged);
  EXPECT_NEAR(std::log(*fit->threshold), static_cast<double>(exact.t), tolerance);
  EXPECT_NEAR(std::log(*fit->slope), static_cast<double>(exact.q), 10 * tolerance);
  // A sum of as many terms as levels, each rounded to 1e-16 of itself.
  const auto ll = static_cast<double>(exact.log_likelihood);
  EXPECT_NEAR(*fit->log_likelihood, ll, 1e-13 * std::max(1.0, std::abs(ll)));
}

// Hard: both parameters are fixed by two numbers, nothing is left over; the answer is closed: u is known at both sizes,
// so slope = (u2 - u1) / ln(x2 / x1).
TEST(ExactMaximum, OfTwoLevelsIsTheCurveThroughBothPoints) {
  for (const double n : {20.0, 1e6, 2e9}) {
    const double first = std::round(0.45 * n), second = std::round(0.9 * n);
    const std::vector<Level> levels{{0.7, first, n, -1}, {1.6, second, n, -1}};
    const Digits u1 = exponent_at(Digits(first) / Digits(n)), u2 = exponent_at(Digits(second) / Digits(n));
    const Digits slope = (u2 - u1) / log(Digits(1.6) / Digits(0.7)), t = log(Digits(0.7)) - u1 / slope;

    const auto fit = fit_psychometric(levels, {.with_posterior = false});

    ASSERT_TRUE(fit && fit->threshold && fit->slope);
    EXPECT_NEAR(std::log(*fit->threshold), static_cast<double>(t), 1e-10) << n;
    EXPECT_NEAR(*fit->slope / static_cast<double>(slope), 1, 1e-9) << n;
    // Deviance is a sum of differences that vanish at the curve: rounding of n terms of 1e-16 each.
    EXPECT_NEAR(fit->deviance.value(), 0, 1e-15 * n + 1e-10) << n;
  }
}

// Hard: the ln likelihood is 1e6 to 1e10, a change by 1e-8 of the threshold is below its last bit.
TEST(ExactMaximum, IsFoundWithMillionsAndThousandsOfMillionsOfTrialsPerLevel) {
  for (const double n : {1e6, 2e9})
    expect_the_maximum(expected_counts({0.5, 0.8, 1.1, 1.5, 2.2}, n, 1.234567, 3.3, 0), 0);
}

// Hard: 1 - psi of the largest sizes is far below the smallest double next to 1.
TEST(ExactMaximum, IsFoundOverSixDecadesOfSizes) {
  expect_the_maximum(expected_counts({1e-3, 1e-2, 0.1, 1, 10, 100, 1000}, 400, 0.6, 0.7, 0), 0);
  expect_the_maximum(expected_counts({1e-3, 1e-2, 0.1, 0.4, 0.5, 0.7, 10, 100, 1000}, 400, 0.6, 4, 0), 0);
}

// Hard: squares or products of such sizes leave the number range.
TEST(ExactMaximum, IsFoundInTinyAndHugeUnits) {
  for (const double unit : {1e-250, 1e-30, 1e-9, 1e12, 1e200}) {
    auto levels = expected_counts({0.5, 0.8, 1.1, 1.5, 2.2}, 40, 1, 3, 0.01);
    for (Level& level : levels) level.size *= unit;
    expect_the_maximum(levels, 0.01, 2e-9);
  }
}

// Hard: psi rounds to 1 there, so that ln(1 - psi) through psi is -36 or -infinity in place of -z; fits that do so
// report convergence at a threshold tens of percent off.
TEST(ExactMaximum, IsFoundWithOneErrorAtAThousandThresholds) {
  const std::vector<Level> levels{
      {0.5, 8, 20, -1}, {0.8, 11, 20, -1}, {1.2, 17, 20, -1}, {2, 20, 20, -1}, {1000, 19, 20, -1}};
  expect_the_maximum(levels, 0);
  expect_the_maximum(levels, 0.01);
}

// Hard: the model is wrong. A lapse of 5 % that the fit does not know moves the maximum; it must be the maximum of the
// wrong model all the same, tens of percent above the truth, and the free lapse must find the truth.
TEST(ExactMaximum, OfALapseThatTheFitDoesNotKnowIsTheWrongModelsOwnAndTheFreeLapseFindsTheTruth) {
  const auto levels = expected_counts({0.4, 0.6, 0.8, 1, 1.3, 1.7, 2.5, 4, 6}, 1000, 1, 3.5, 0.05);

  expect_the_maximum(levels, 0);

  const auto wrong = fit_psychometric(levels, {.with_posterior = false});
  const auto free = fit_psychometric(levels, {.fixed_lapse = std::nullopt, .with_posterior = false});
  ASSERT_TRUE(wrong && free && wrong->threshold && free->threshold);
  EXPECT_GT(*wrong->threshold, 1.1);
  // Counts rounded to whole numbers: 0.5 of 1000 at each of nine sizes, standard errors below 1 %.
  EXPECT_NEAR(*free->threshold, 1, 2e-3);
  EXPECT_NEAR(free->lapse, 0.05, 1e-3);
  EXPECT_GT(2 * (*free->log_likelihood - *wrong->log_likelihood), 2.71);
}

// The profile limits are where the 50-digit likelihood, maximised over the slope, has fallen by 3.84 / 2.
TEST(ExactMaximum, ProfileLimitsLieAtTheStatedDropOfTheLikelihood) {
  const auto levels = expected_counts({0.5, 0.8, 1.1, 1.5, 2.2}, 2e6, 1.234567, 3.3, 0);
  const auto fit = fit_psychometric(levels, {.with_posterior = false});
  ASSERT_TRUE(fit && fit->ci95.low && fit->ci95.high);
  const auto top = maximum_50(levels, std::log(*fit->threshold), std::log(*fit->slope), 0);
  for (const double limit : {*fit->ci95.low, *fit->ci95.high}) {
    const Digits t = log(Digits(limit)), h("1e-12");
    Digits q = log(Digits(*fit->slope));
    const auto f = [&](const Digits& at) { return testing::log_likelihood_50(levels, t, at, 0); };
    for (int i = 0; i < 20; ++i) {
      const Digits up = f(q + h), mid = f(q), down = f(q - h);
      q -= (up - down) * h / 2 / (up - 2 * mid + down);
    }

    const Digits drop = 2 * (top.log_likelihood - f(q));

    // Differences of 1e7 in double: 1e-9 each, and the root search's own 1e-10 of the limit.
    EXPECT_NEAR(static_cast<double>(drop), 3.841458820694124, 1e-5);
  }
}

}  // namespace
}  // namespace todbench
