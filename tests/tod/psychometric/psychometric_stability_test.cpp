// SPDX-License-Identifier: GPL-3.0-or-later
// The arithmetic of the fit: reference values of the logarithms, derivatives, and data that describe the same thing in
// another way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tests/tod/psychometric/psychometric_support.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/psychometric_likelihood.h"
#include "tod/psychometric/psychometric_model.h"
#include "tod/psychometric/psychometric_search.h"

namespace todbench {
namespace {

using nlohmann::json;
using testing::geometric;
using testing::reference_cases;

TEST(PsychometricStability, LogarithmsAgreeWith34DigitReferences) {
  const json all = reference_cases();
  ASSERT_EQ(all["stability_vectors"].size(), 9u);
  for (const json& v : all["stability_vectors"]) {
    const auto at = [&v](const char* key) { return std::stod(v[key].get<std::string>()); };
    SCOPED_TRACE(v.dump());
    const double threshold = at("x75"), slope = at("b"), lapse = at("lapse");
    const Link link = make_link(PsychometricForm::size, lapse);

    const double u = slope * (std::log(at("x")) - std::log(threshold));
    const LogProbabilities p = log_probabilities(link, u);

    // The exponent u carries a rounding error of about |u| 1e-16 plus slope times that of the two logarithms (up to
    // 28), and z inherits it as a relative error; 4e-13 covers slope 50. The threshold itself is given to 20 digits but
    // rounded to a double on reading.
    EXPECT_NEAR(p.right, at("log_psi"), 4e-13 * std::max(1.0, std::abs(at("log_psi"))));
    EXPECT_NEAR(p.wrong, at("log_1m_psi"), 4e-13 * std::abs(at("log_1m_psi")));
    EXPECT_NEAR(psychometric(PsychometricForm::size, at("x"), threshold, slope, lapse), at("psi"), 4e-13);
    EXPECT_NEAR(at("a") * std::pow(link.kappa, 1 / slope), threshold, 1e-15 * threshold);
  }
}

TEST(PsychometricStability, PsiIsExactAtTheEnds) {
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
    EXPECT_EQ(psychometric(form, 0, 1, 3, 0.02), 0.25);
    EXPECT_EQ(psychometric(form, 1e300, 1, 50, 0), 1.0);
    EXPECT_EQ(psychometric(form, 1e-300, 1, 50, 0), 0.25);
    EXPECT_NEAR(psychometric(form, 1e300, 1e-10, 50, 0.02), 0.98, 1e-15);
  }
}

TEST(PsychometricStability, DerivativesAgreeWithDifferencesOfTheLikelihood) {
  const PooledCounts counts = pool(std::vector<Level>{{0.5, 6, 20}, {0.9, 11, 20}, {1.4, 17, 20}, {3, 19, 20}});
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
    for (const double lapse : {0.003, 0.06}) {
      const PsychometricPlace place{0.1, std::log(2.5), lapse};

      const Expansion<3> e = expand_likelihood(counts, form, place);

      EXPECT_NEAR(e.value, log_likelihood(counts, form, place), 1e-12);
      for (std::size_t i = 0; i < 3; ++i) {
        const double h = i == 2 ? 1e-6 : 1e-5;
        PsychometricPlace up = place, down = place;
        up[i] += h;
        down[i] -= h;
        const Expansion<3> above = expand_likelihood(counts, form, up), below = expand_likelihood(counts, form, down);
        // Central differences: third derivatives (up to about 1e7 in the lapse) times h^2 / 6, and rounding 1e-14 / h.
        const auto tolerance = [](double scale) { return 1e-5 * std::max(1.0, std::abs(scale)); };
        EXPECT_NEAR(e.gradient[i], (above.value - below.value) / (2 * h), tolerance(e.gradient[i])) << i;
        for (std::size_t j = 0; j < 3; ++j)
          EXPECT_NEAR(e.hessian[i][j], (above.gradient[j] - below.gradient[j]) / (2 * h), tolerance(e.hessian[i][j]))
              << i << j;
      }
    }
  }
}

TEST(PsychometricStability, TableAgreesWithTheFunctionsItStandsFor) {
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity}) {
    for (const double lapse : {0.0, 0.001, 0.1}) {
      const LinkTable table(make_link(form, lapse));
      for (int i = 0; i < 400; ++i) {
        const double t = -8 + i * 0.0401;
        for (const double right : {0.0, 1.0}) {
          PooledCounts one;
          one.levels = {{0, right, 1 - right}};

          const double tabulated = table.log_likelihood(one, t, 5.0);

          // Quintic cells of 1/16: (1/16)^6 / 46080 = 1.3e-12 times the sixth derivative. Near the lapse ln(1 - psi)
          // bends within 1/z of u: about z^6 = 1e5 at lapse 0.001 (z = 7).
          const double exact = log_likelihood(one, form, {t, std::log(5.0), lapse});
          EXPECT_NEAR(tabulated, exact, 1e-7 * std::max(1.0, std::abs(exact))) << t << " " << right;
        }
      }
    }
  }
}

void expect_same(const PsychometricFit& a, const PsychometricFit& b, double scale) {
  // Whatever is equal up to the order of rows or the unit of size must agree to 1e-10.
  const auto near = [](std::optional<double> x, std::optional<double> y, double factor, const char* what) {
    ASSERT_EQ(x.has_value(), y.has_value()) << what;
    if (x) {
      EXPECT_NEAR(*x * factor, *y, 1e-10 * std::abs(*y)) << what;
    }
  };
  EXPECT_EQ(a.verdict, b.verdict);
  near(a.threshold, b.threshold, scale, "threshold");
  near(a.slope, b.slope, 1, "slope");
  near(a.ci95.low, b.ci95.low, scale, "ci95 low");
  near(a.ci95.high, b.ci95.high, scale, "ci95 high");
  near(a.ci90.low, b.ci90.low, scale, "ci90 low");
  near(a.ci90.high, b.ci90.high, scale, "ci90 high");
  near(a.log_likelihood, b.log_likelihood, 1, "log likelihood");
  near(a.se_ln_threshold, b.se_ln_threshold, 1, "standard error");
  if (a.posterior && b.posterior) {
    near(a.posterior->median, b.posterior->median, scale, "posterior median");
    near(a.posterior->low, b.posterior->low, scale, "posterior low");
    near(a.posterior->high, b.posterior->high, scale, "posterior high");
  }
}

// The settings under which every twin is compared.
std::vector<FitOptions> all_options() {
  std::vector<FitOptions> options;
  for (const PsychometricForm form : {PsychometricForm::size, PsychometricForm::acuity})
    for (const std::optional<double>& lapse : {std::optional(0.0), std::optional(0.02), std::optional<double>()})
      options.push_back({form, lapse, true});
  return options;
}

TEST(PsychometricStability, SingleTrialRowsInAnyOrderAreThePooledData) {
  const json reference = reference_cases();
  const std::vector<Level> pooled = testing::levels_of_case(reference, "sim_unsorted");
  std::vector<Level> single;
  for (const Level& level : pooled)
    for (int i = 0; i < static_cast<int>(level.total); ++i)
      single.push_back({level.size, i < level.correct ? 1.0 : 0.0, 1, -1});
  const RandomStream stream(7, "shuffle");
  for (std::size_t i = single.size(); i-- > 1;) std::swap(single[i], single[stream.below(i + 1, i)]);
  single.push_back({3.3, 0, 0, -1});  // a row without trials says nothing
  for (const FitOptions& options : all_options()) {
    const auto a = fit_psychometric(pooled, options), b = fit_psychometric(single, options);

    ASSERT_TRUE(a && b);
    expect_same(*a, *b, 1);
  }
}

TEST(PsychometricStability, UnitsOfSizeDropOut) {
  const json reference = reference_cases();
  for (const char* id :
       {"sim_7x30", "step_with_one_lapse", "all_but_one_correct", "below_chance", "all_correct_1level"}) {
    const std::vector<Level> levels = testing::levels_of_case(reference, id);
    for (const double scale : {1e-9, 1e12}) {
      std::vector<Level> scaled = levels;
      for (Level& level : scaled) level.size *= scale;
      for (const FitOptions& options : all_options()) {
        SCOPED_TRACE(std::string(id) + " x " + std::to_string(scale));

        const auto a = fit_psychometric(levels, options), b = fit_psychometric(scaled, options);

        ASSERT_TRUE(a && b);
        expect_same(*a, *b, scale);
      }
    }
  }
}

TEST(PsychometricStability, BlankTrialsChangeOnlyTheLikelihood) {
  const std::vector<Level> levels{{0.5, 6, 20}, {0.9, 11, 20}, {1.4, 17, 20}, {3, 20, 20}};
  std::vector<Level> with_blanks = levels;
  with_blanks.push_back({0, 7, 20, -1});

  const auto a = fit_psychometric(levels, {}), b = fit_psychometric(with_blanks, {});

  ASSERT_TRUE(a && b);
  const double blanks = 7 * std::log(0.25) + 13 * std::log(0.75);
  EXPECT_NEAR(*b->log_likelihood - *a->log_likelihood, blanks, 1e-12);
  EXPECT_EQ(b->degrees_of_freedom, a->degrees_of_freedom + 1);
  EXPECT_NEAR(*a->threshold, *b->threshold, 1e-12);
  EXPECT_NEAR(*a->ci95.low, *b->ci95.low, 1e-10);
  EXPECT_NEAR(a->posterior->high, b->posterior->high, 1e-10);
}

TEST(PsychometricStability, TwoThousandMillionTrialsAreFittedToTheirResolution) {
  const double n = 2e9, truth = 1.37, slope = 4.4;
  std::vector<Level> levels;
  for (const double size : geometric(0.8, 2, 7))
    levels.push_back({size, std::round(n * psychometric(PsychometricForm::size, size, truth, slope, 0)), n, -1});

  const auto fit = fit_psychometric(levels, {});

  // Whole counts move proportions by 2.5e-10, hence the threshold by less than 1e-9.
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->threshold.value(), truth, 1e-9);
  EXPECT_NEAR(fit->slope.value(), slope, 1e-7);
  EXPECT_LT(fit->deviance.value(), 1e-6);
  // The interval is +-1.96 standard errors: so many trials are normal. It is a difference of likelihoods of 1e9, good
  // to 1e-7 of 3.84.
  ASSERT_TRUE(fit->ci95.low && fit->ci95.high && fit->se_ln_threshold);
  EXPECT_NEAR(std::log(*fit->ci95.high / truth) / *fit->se_ln_threshold, 1.959964, 1e-3);
  EXPECT_NEAR(std::log(truth / *fit->ci95.low) / *fit->se_ln_threshold, 1.959964, 1e-3);
  EXPECT_NEAR(std::log(fit->posterior->high / truth) / *fit->se_ln_threshold, 1.959964, 1e-2);
}

TEST(PsychometricStability, OneErrorAtAThousandThresholdsIsSeenAtLapseZero) {
  // psi rounds to 1 there; through 1 - psi the error would cost 36 and no more.
  std::vector<Level> levels{{0.5, 8, 20}, {0.8, 11, 20}, {1.2, 17, 20}, {2, 20, 20}, {1000, 19, 20}};

  const auto strict = fit_psychometric(levels, {.fixed_lapse = 0.0});
  const auto lenient = fit_psychometric(levels, {.fixed_lapse = 0.01});

  ASSERT_TRUE(strict && lenient);
  EXPECT_LT(strict->slope.value(), 1.0);
  EXPECT_GT(lenient->slope.value(), 2.0);
  const double direct =
      testing::plain_log_likelihood(levels, PsychometricForm::size, std::log(*strict->threshold), *strict->slope, 0);
  EXPECT_NEAR(*strict->log_likelihood, direct, 1e-9);
}

void expect_finite(const PsychometricFit& fit) {
  const auto check = [](std::optional<double> x, const char* what) {
    if (x) {
      EXPECT_TRUE(std::isfinite(*x)) << what;
    }
  };
  check(fit.threshold, "threshold");
  check(fit.slope, "slope");
  check(fit.ci95.low, "ci95 low");
  check(fit.ci95.high, "ci95 high");
  check(fit.ci90.low, "ci90 low");
  check(fit.ci90.high, "ci90 high");
  check(fit.log_likelihood, "log likelihood");
  check(fit.deviance, "deviance");
  check(fit.se_ln_threshold, "standard error");
  check(fit.lapse, "lapse");
  check(fit.variance_inflation, "inflation");
  if (fit.threshold && fit.ci95.low) {
    EXPECT_LE(*fit.ci95.low, *fit.threshold * (1 + 1e-9));
  }
  if (fit.threshold && fit.ci95.high) {
    EXPECT_GE(*fit.ci95.high, *fit.threshold * (1 - 1e-9));
  }
  ASSERT_EQ(fit.posterior.has_value(), fit.verdict != FitVerdict::flat_or_decreasing);
  if (!fit.posterior) return;
  EXPECT_TRUE(std::isfinite(fit.posterior->median));
  EXPECT_LT(fit.posterior->low, fit.posterior->median);
  EXPECT_LT(fit.posterior->median, fit.posterior->high);
}

TEST(PsychometricStability, AnyCountsGiveFiniteNumbersAndIntervalsRoundTheThreshold) {
  const RandomStream stream(11, "counts");
  for (std::uint64_t i = 0; i < 60; ++i) {
    const RandomStream one = stream.sub(i);
    std::vector<Level> levels;
    const auto count = 1 + one.below(6, 0);
    for (std::uint64_t j = 0; j < count; ++j) {
      const double total = static_cast<double>(1 + one.below(j % 2 == 0 ? 4 : 30, 10 + j));
      const double size = std::exp(12 * (one.uniform(30 + j) - 0.5) * one.uniform(1));
      levels.push_back({size, static_cast<double>(one.below(static_cast<std::uint64_t>(total) + 1, 50 + j)), total,
                        one.below(2, 2) == 0 ? -1 : static_cast<int>(j % 3)});
    }
    FitOptions options = all_options()[i % 6];
    SCOPED_TRACE("data set " + std::to_string(i));

    const auto fit = fit_psychometric(levels, options);

    ASSERT_TRUE(fit);
    expect_finite(*fit);
  }
}

TEST(PsychometricStability, LevelsAtTheEndsOfTheNumberRangeStayFinite) {
  const double tiny = std::numeric_limits<double>::min();
  for (const FitOptions& options : all_options()) {
    const auto fit =
        fit_psychometric(std::vector<Level>{{tiny, 5, 20}, {1e-100, 6, 20}, {1, 18, 20}, {1e300, 20, 20}}, options);

    ASSERT_TRUE(fit);
    expect_finite(*fit);
  }
}

}  // namespace
}  // namespace todbench
