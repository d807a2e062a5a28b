// SPDX-License-Identifier: GPL-3.0-or-later
// Fits against reference cases computed by two other methods, against a second implementation of the likelihood, and
// every verdict.
#include "tod/psychometric/psychometric_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tests/tod/psychometric/psychometric_support.h"
#include "tod/psychometric/acuity.h"

namespace todbench {
namespace {

using nlohmann::json;
using testing::geometric;
using testing::levels_of;
using testing::plain_log_likelihood;
using testing::plain_profile;
using testing::reference_cases;

constexpr double drop95 = 3.841458820694124, drop90 = 2.705543454095404;

FitOptions options_for(const std::string& setting) {
  FitOptions options;
  if (setting == "lapse_0.01") options.fixed_lapse = 0.01;
  if (setting == "lapse_free") options.fixed_lapse.reset();
  return options;
}

// One limit of the reference: 0 and "inf" mean that the side is open.
std::optional<double> limit(const json& value) {
  if (value.is_string() || value.get<double>() == 0) return std::nullopt;
  return value.get<double>();
}

void expect_close(const std::optional<double>& ours, const std::optional<double>& theirs, double relative,
                  const char* what) {
  ASSERT_EQ(ours.has_value(), theirs.has_value()) << what;
  if (ours) {
    EXPECT_NEAR(*ours, *theirs, relative * std::abs(*theirs)) << what;
  }
}

std::optional<double> value_of(const json& value) {
  return value.is_null() ? std::nullopt : std::optional(value.get<double>());
}

void expect_intervals(const PsychometricFit& fit, const json& reference) {
  // 1e-6 as the reference states for itself; entries it could not verify to 6 digits are good to 1e-4.
  const bool exact = reference["verified_6_digits"].is_null() || reference["verified_6_digits"].get<bool>() ||
                     fit.verdict == FitVerdict::underdetermined;
  const double relative = exact ? 1e-6 : 1e-4;
  const auto low90 = limit(reference["profile_ci90_x75"][0]), high90 = limit(reference["profile_ci90_x75"][1]);
  auto low95 = limit(reference["profile_ci95_x75"][0]), high95 = limit(reference["profile_ci95_x75"][1]);
  const bool low_open = !low95, high_open = !high95;
  // With one side open the other is the one-sided 95 % limit: the 90 % crossing.
  if (low_open && !high_open) high95 = high90;
  if (high_open && !low_open) low95 = low90;
  expect_close(fit.ci90.low, low90, relative, "ci90 low");
  expect_close(fit.ci90.high, high90, relative, "ci90 high");
  expect_close(fit.ci95.low, low95, relative, "ci95 low");
  expect_close(fit.ci95.high, high95, relative, "ci95 high");
}

void expect_posterior(const PsychometricFit& fit, const json& reference) {
  ASSERT_TRUE(fit.posterior);
  const json& posterior = reference["posterior"];
  if (!posterior["verified"].get<bool>()) return;
  const double low = posterior["ci95"][0], high = posterior["ci95"][1];
  // 1e-3 of the interval. Entries made on a grid of +-9 standard errors lack what lies outside it; with two levels that
  // is a tail worth 3.5e-3 of the interval (the untruncated value is tested on its own below), elsewhere nothing.
  const bool long_tail_cut = fit.trials == 40 && posterior.contains("method");
  const double tolerance = (long_tail_cut ? 4e-3 : 1e-3) * (high - low);
  EXPECT_NEAR(fit.posterior->median, posterior["median"].get<double>(), tolerance);
  EXPECT_NEAR(fit.posterior->low, low, tolerance);
  EXPECT_NEAR(fit.posterior->high, high, tolerance);
  const bool bound = std::max(posterior["edge_density_ratio"][0].get<double>(),
                              posterior["edge_density_ratio"][1].get<double>()) > 0.01;
  EXPECT_EQ(fit.posterior->prior_bound, bound);
}

TEST(PsychometricFit, ReproducesEveryReferenceCaseAtEveryLapseSetting) {
  const json all = reference_cases();
  ASSERT_EQ(all["cases"].size(), 19u);
  for (const json& one : all["cases"]) {
    const std::vector<Level> levels = levels_of(one);
    for (const auto& [setting, reference] : one["fits"].items()) {
      SCOPED_TRACE(one["id"].get<std::string>() + ", " + setting);

      const auto fit = fit_psychometric(levels, options_for(setting));

      ASSERT_TRUE(fit) << fit.error().message;
      EXPECT_EQ(to_string(fit->verdict), reference["verdict"].get<std::string>());
      // On a ridge any member is as good: the likelihood is compared, not the place.
      const bool unique = !reference.value("x75_not_unique", false);
      if (unique) {
        expect_close(fit->threshold, value_of(reference["x75"]), 1e-6, "threshold");
        expect_close(fit->slope, value_of(reference["b"]), 1e-6, "slope");
        expect_close(fit->se_ln_threshold, value_of(reference["se_ln_x75_observed_info"]), 1e-5, "standard error");
        if (reference["lapse"].is_number()) {
          EXPECT_NEAR(fit->lapse, reference["lapse"].get<double>(), 1e-8);
        }
      }
      const double ll = reference["loglik"];
      ASSERT_TRUE(fit->log_likelihood);
      EXPECT_NEAR(*fit->log_likelihood, ll, 1e-8 * std::max(1.0, std::abs(ll)));
      // The deviance is a difference of two likelihoods of which each is known to 1e-8.
      EXPECT_NEAR(*fit->deviance, reference["deviance_pooled"].get<double>(), 2e-8 * std::max(1.0, std::abs(ll)));
      EXPECT_EQ(fit->degrees_of_freedom, reference["df_pooled"].get<int>());
      expect_intervals(*fit, reference);
      expect_posterior(*fit, reference);
    }
  }
}

TEST(PsychometricFit, RejectsWrongInputs) {
  const json all = reference_cases();
  for (const json& one : all["input_errors"]) {
    if (one["levels"].size() != one["n_correct"].size()) continue;  // cannot be expressed as rows
    SCOPED_TRACE(one["id"].get<std::string>());

    const auto fit = fit_psychometric(levels_of(one), {});

    ASSERT_FALSE(fit);
    EXPECT_EQ(fit.error().code, ErrorCode::invalid_input);
  }
  const double inf = INFINITY;
  for (const Level& row :
       {Level{inf, 1, 2}, Level{1, 0.5, 2}, Level{1, 1, 2.5}, Level{1, 0, inf}, Level{1, NAN, 3}, Level{1, 0, -1}}) {
    const auto fit = fit_psychometric(std::vector{Level{1, 3, 4}, row}, {});

    ASSERT_FALSE(fit);
    EXPECT_EQ(fit.error().code, ErrorCode::invalid_input);
    EXPECT_THAT(fit.error().message, ::testing::StartsWith("row 2:"));
  }
}

TEST(PsychometricFit, RejectsALapseOutsideItsDomain) {
  for (const double lapse : {-0.01, 0.11, 0.25, static_cast<double>(NAN)}) {
    const auto fit = fit_psychometric(std::vector<Level>{{1, 3, 4}, {2, 4, 4}}, {.fixed_lapse = lapse});

    EXPECT_FALSE(fit) << lapse;
  }
}

TEST(PsychometricFit, SaysNoDataWithoutATrialAtAPositiveSize) {
  for (const std::vector<Level>& levels :
       {std::vector<Level>{}, std::vector<Level>{{0, 3, 12}}, std::vector<Level>{{1, 0, 0}, {2, 0, 0}}}) {
    const auto fit = fit_psychometric(levels, {});

    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->verdict, FitVerdict::no_data);
    EXPECT_FALSE(fit->threshold || fit->slope || fit->ci95.low || fit->ci95.high || fit->posterior ||
                 fit->log_likelihood);
  }
}

TEST(PsychometricFit, SaysSlopeUnidentifiableForOneLevelAndGivesOnlyAnInterval) {
  const std::vector<Level> levels{{2, 30, 40}};

  const auto fit = fit_psychometric(levels, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::slope_unidentifiable);
  EXPECT_FALSE(fit->threshold);
  EXPECT_FALSE(fit->slope);
  // Three quarters right at this size: it is the threshold at any slope, so it must be inside; the slope bound 0.1
  // makes the ends far.
  ASSERT_TRUE(fit->ci95.low && fit->ci95.high);
  EXPECT_LT(*fit->ci95.low, 2 * std::exp(-1.0));
  EXPECT_GT(*fit->ci95.high, 2 * std::exp(1.0));
  for (const double end : {*fit->ci95.low, *fit->ci95.high})
    EXPECT_NEAR(2 * (*fit->log_likelihood - plain_profile(levels, PsychometricForm::size, std::log(end), 0)), drop95,
                1e-6);
}

TEST(PsychometricFit, SaysFlatOrDecreasingWhereTheSlopeIsAtItsLowerBound) {
  const auto fit = fit_psychometric(std::vector<Level>{{1, 16, 20}, {2, 14, 20}, {3, 12, 20}, {4, 9, 20}}, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::flat_or_decreasing);
  EXPECT_FALSE(fit->usable());
  EXPECT_FALSE(fit->se_ln_threshold);
  EXPECT_FALSE(fit->threshold || fit->ci95.low || fit->ci95.high || fit->ci90.low || fit->ci90.high || fit->posterior);
  EXPECT_NEAR(fit->slope.value(), 0.1, 1e-9);
}

TEST(PsychometricFit, SaysExtrapolatedWhereTheThresholdIsOutsideTheSizes) {
  const auto fit =
      fit_psychometric(std::vector<Level>{{1, 30, 100}, {1.2, 37, 100}, {1.4, 46, 100}, {1.6, 58, 100}}, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::extrapolated);
  EXPECT_GT(fit->threshold.value(), 1.6);
  EXPECT_TRUE(fit->usable());
}

TEST(PsychometricFit, StatesNoThresholdOutsideTheSizesWithAnOpenInterval) {
  // Twenty answers near chance: the likelihood hardly changes from 4 mrad on, and its maximum is far away.
  const std::vector<Level> levels{{0.7875, 1, 2}, {0.95, 0, 2}, {1.14, 0, 2},    {1.38, 1, 2}, {1.66, 2, 2},
                                  {2, 0, 2},      {2.41, 1, 2}, {2.90625, 1, 2}, {3.5, 1, 2},  {4.21875, 0, 2}};

  const auto fit = fit_psychometric(levels, {});

  ASSERT_TRUE(fit && fit->threshold);
  EXPECT_EQ(fit->verdict, FitVerdict::extrapolated);
  EXPECT_GT(*fit->threshold, 1000);
  EXPECT_GT(fit->ci95.low.value(), 4);
  EXPECT_FALSE(fit->ci95.high);
  EXPECT_FALSE(stated_threshold(*fit));
  EXPECT_FALSE(stated_acuity_per_mrad(*fit));
  const auto step =
      fit_psychometric(std::vector<Level>{{1.52, 1, 4}, {2.2, 1, 4}, {3.2, 1, 4}, {4.65, 0, 4}, {6.75, 2, 4}}, {});
  ASSERT_TRUE(step && !step->ci95.high);
  EXPECT_FALSE(stated_threshold(*step)) << "only the largest size is above chance";
  const auto closed =
      fit_psychometric(std::vector<Level>{{1, 30, 100}, {1.2, 37, 100}, {1.4, 46, 100}, {1.6, 58, 100}}, {});
  ASSERT_TRUE(closed && closed->ci95.low && closed->ci95.high);
  EXPECT_EQ(stated_threshold(*closed), closed->threshold) << "outside the sizes, with both ends";
}

TEST(PsychometricFit, GivesNoThresholdForAStepThatTouchesNoLevel) {
  const std::vector<Level> levels{{0.1, 10, 40}, {1, 10, 40}, {10, 40, 40}, {100, 40, 40}};

  const auto fit = fit_psychometric(levels, {});

  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->verdict, FitVerdict::step);
  EXPECT_FALSE(fit->threshold);
  EXPECT_FALSE(fit->slope);
  ASSERT_TRUE(fit->ci95.low && fit->ci95.high);
  EXPECT_GT(*fit->ci95.low, 1.0);
  EXPECT_LT(*fit->ci95.high, 10.0);
  for (const double end : {*fit->ci95.low, *fit->ci95.high})
    EXPECT_NEAR(2 * (*fit->log_likelihood - plain_profile(levels, PsychometricForm::size, std::log(end), 0)), drop95,
                1e-6);
}

TEST(PsychometricFit, AllWrongIsAboveRangeWithALowerLimitAndAllRightBelowRangeWithAnUpperLimit) {
  const auto wrong = fit_psychometric(std::vector<Level>{{1, 0, 20}, {2, 0, 20}, {3, 0, 20}}, {});
  const auto right = fit_psychometric(std::vector<Level>{{1, 20, 20}, {2, 20, 20}, {3, 20, 20}}, {});

  ASSERT_TRUE(wrong && right);
  EXPECT_EQ(wrong->verdict, FitVerdict::above_range);
  EXPECT_TRUE(wrong->ci95.low.has_value() && !wrong->ci95.high.has_value());
  EXPECT_EQ(right->verdict, FitVerdict::below_range);
  EXPECT_TRUE(!right->ci95.low.has_value() && right->ci95.high.has_value());
  for (const auto* fit : {&*wrong, &*right}) {
    EXPECT_FALSE(fit->threshold);
    EXPECT_FALSE(fit->usable());
    EXPECT_TRUE(fit->posterior->prior_bound);
  }
}

// Data of a simulated observer with either form; the seeds are arbitrary.
std::vector<Level> simulated(PsychometricForm form, const std::vector<double>& sizes, int total, double slope,
                             double lapse, std::uint64_t seed) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const double p = psychometric(form, sizes[i], 1.0, slope, lapse);
    levels.push_back({sizes[i], testing::binomial_draw(p, total, RandomStream(seed, "answers").sub(i)),
                      static_cast<double>(total), -1});
  }
  return levels;
}

TEST(PsychometricFit, FindsTheMaximumAndTheCrossingsOfAnIndependentLikelihoodInBothForms) {
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(std::string(to_string(form)) + ", seed " + std::to_string(seed));
      const double lapse = seed % 3 == 0 ? 0.02 : 0.0, slope = seed % 2 == 0 ? 2.0 : 5.0;
      const std::vector<Level> levels = simulated(form, geometric(0.5, 2, 9), 20, slope, lapse, seed);

      const auto fit = fit_psychometric(levels, {.form = form, .fixed_lapse = lapse});

      ASSERT_TRUE(fit);
      ASSERT_TRUE(fit->threshold && fit->ci95.low && fit->ci95.high && fit->ci90.low && fit->ci90.high);
      EXPECT_NEAR(psychometric(form, *fit->threshold, *fit->threshold, *fit->slope, lapse), 0.75, 1e-15);
      const double ll = plain_log_likelihood(levels, form, std::log(*fit->threshold), *fit->slope, lapse);
      EXPECT_NEAR(ll, *fit->log_likelihood, 1e-10);
      // No place of a scan over both parameters is higher.
      for (int i = 0; i <= 60; ++i)
        EXPECT_LE(plain_profile(levels, form, std::log(0.3) + i * std::log(10.0) / 60, lapse), ll + 1e-9);
      // Limits good to 1e-9 and slopes of the drop up to about 40 per unit of ln size: 1e-6 holds with room.
      const auto drop = [&](double size) { return 2 * (ll - plain_profile(levels, form, std::log(size), lapse)); };
      EXPECT_NEAR(drop(*fit->ci95.low), drop95, 1e-6);
      EXPECT_NEAR(drop(*fit->ci95.high), drop95, 1e-6);
      EXPECT_NEAR(drop(*fit->ci90.low), drop90, 1e-6);
      EXPECT_NEAR(drop(*fit->ci90.high), drop90, 1e-6);
    }
  }
}

TEST(PsychometricFit, AcuityFormIsAWeibullInOneOverSizeThroughTheSameThreshold) {
  // P = 0.25 + 0.75 / 1.5^((x / a)^b) with acuity x = 1 / size and threshold acuity a = 1 / S75.
  const double s75 = 1.7, b = 3.2;
  for (const double size : {0.4, 1.0, 1.7, 2.5, 6.0}) {
    const double expected = 0.25 + 0.75 / std::pow(1.5, std::pow(s75 / size, b));

    EXPECT_NEAR(psychometric(PsychometricForm::acuity, size, s75, b, 0), expected, 1e-15);
  }
}

TEST(PsychometricFit, RecoversTheAcuityFormFromManyTrialsAndTellsItFromTheSizeForm) {
  std::vector<Level> levels;
  for (const double size : geometric(0.7, 1.5, 9)) {
    const double n = 1e7;
    levels.push_back({size, std::round(n * psychometric(PsychometricForm::acuity, size, 1, 4, 0)), n, -1});
  }

  const auto own = fit_psychometric(levels, {.form = PsychometricForm::acuity});
  const auto other = fit_psychometric(levels, {.form = PsychometricForm::size});

  ASSERT_TRUE(own && other);
  // Rounding to whole counts moves a proportion by 5e-8.
  EXPECT_NEAR(own->threshold.value(), 1.0, 1e-6);
  EXPECT_NEAR(own->slope.value(), 4.0, 1e-5);
  EXPECT_LT(own->deviance.value(), 1e-3);
  EXPECT_GT(other->deviance.value(), 1e4);
}

// Equal-tailed limits and median of the posterior by the plainest possible sum over midpoints.
Posterior summed_posterior(const std::vector<Level>& levels, double lapse) {
  double first = INFINITY, last = 0;
  for (const Level& level : levels) {
    first = std::min(first, level.size);
    last = std::max(last, level.size);
  }
  constexpr int nt = 900, nq = 240;
  const double low = std::log(first / 10), range = std::log(last * 10) - low, low_q = std::log(0.1),
               range_q = std::log(500.0);
  std::vector<double> marginal(nt);
  double total = 0;
  for (int i = 0; i < nt; ++i) {
    for (int j = 0; j < nq; ++j) {
      const double q = low_q + range_q * (j + 0.5) / nq, x = (q - std::log(3.5)) / 0.6;
      marginal[static_cast<std::size_t>(i)] += std::exp(
          plain_log_likelihood(levels, PsychometricForm::size, low + range * (i + 0.5) / nt, std::exp(q), lapse) -
          x * x / 2);
    }
    total += marginal[static_cast<std::size_t>(i)];
  }
  const auto quantile = [&](double share) {
    double sum = 0;
    int i = 0;
    while (sum + marginal[static_cast<std::size_t>(i)] < share * total) sum += marginal[static_cast<std::size_t>(i++)];
    return std::exp(low + range * (i + (share * total - sum) / marginal[static_cast<std::size_t>(i)]) / nt);
  };
  return {quantile(0.5), quantile(0.025), quantile(0.975), false};
}

TEST(PsychometricFit, PosteriorKeepsTheLongTailOfTwoLevels) {
  const std::vector<Level> levels{{0.8, 10, 20}, {1.4, 18, 20}};
  const Posterior expected = summed_posterior(levels, 0.01);

  const auto fit = fit_psychometric(levels, {.fixed_lapse = 0.01});

  // Midpoint cells of 0.57 % of size, second-order: the sum is good to about 1e-4 of the interval; 1e-3 tells 3e-3
  // apart.
  ASSERT_TRUE(fit && fit->posterior);
  const double width = expected.high - expected.low;
  EXPECT_NEAR(fit->posterior->median, expected.median, 1e-3 * width);
  EXPECT_NEAR(fit->posterior->low, expected.low, 1e-3 * width);
  EXPECT_NEAR(fit->posterior->high, expected.high, 1e-3 * width);
}

TEST(PsychometricFit, LeavesThePosteriorOutOnRequest) {
  const auto fit = fit_psychometric(std::vector<Level>{{1, 8, 20}, {2, 19, 20}}, {.with_posterior = false});

  ASSERT_TRUE(fit);
  EXPECT_FALSE(fit->posterior);
}

}  // namespace
}  // namespace todbench
