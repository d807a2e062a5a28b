// SPDX-License-Identifier: GPL-3.0-or-later
// Spearman's coefficient against known values, and the coverage of its interval.
#include "tests/support/rank_correlation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

TEST(RankCorrelation, IsSpearmansCoefficient) {
  // 1 - 6 (sum of squared rank differences 194) / (10 (100 - 1)): IQ against hours of television.
  const std::vector<double> iq{106, 100, 86, 101, 99, 103, 97, 113, 112, 110},
      hours{7, 27, 2, 50, 28, 29, 20, 12, 6, 17};
  const auto found = rank_correlation(iq, hours);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->rho, -29.0 / 165, 1e-12);
  // 200000 permutations give 0.6335; 4000 draws, four standard errors.
  EXPECT_NEAR(found->p, 0.6335, 4 * std::sqrt(0.6335 * 0.3665 / 4000));
  EXPECT_LT(*found->ci95.low, found->rho);
  EXPECT_GT(*found->ci95.high, found->rho);
}

TEST(RankCorrelation, GivesEqualValuesTheirMeanRank) {
  const std::vector<double> a{1, 2, 2, 3}, b{1, 2, 3, 4};
  const auto found = rank_correlation(a, b);

  ASSERT_TRUE(found);
  // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4.
  EXPECT_NEAR(found->rho, 4.5 / std::sqrt(4.5 * 5), 1e-12);
}

TEST(RankCorrelation, OfEqualOrderStillHasAnInterval) {
  std::vector<double> a, b;
  for (int i = 0; i < 10; ++i) a.push_back(i), b.push_back(std::exp(i));
  const auto found = rank_correlation(a, b);

  ASSERT_TRUE(found);
  EXPECT_EQ(found->rho, 1);
  EXPECT_EQ(found->ci95.high, 1);
  EXPECT_GT(*found->ci95.low, 0.8);
  EXPECT_LT(*found->ci95.low, 0.98);
}

TEST(RankCorrelation, HoldsTheCoefficientOfThePopulation) {
  constexpr int samples = 60, items = 10;
  constexpr double correlation = 0.8;
  const double truth = 6 / std::numbers::pi * std::asin(correlation / 2);
  int held = 0;
  for (std::uint64_t sample = 0; sample < samples; ++sample) {
    const RandomStream stream = RandomStream(7, "rank_correlation_test").sub(sample);
    std::vector<double> a, b;
    for (std::uint64_t i = 0; i < items; ++i) {
      a.push_back(static_cast<double>(stream.normal(2 * i)));
      b.push_back(correlation * a.back() +
                  std::sqrt(1 - correlation * correlation) * static_cast<double>(stream.normal(2 * i + 1)));
    }
    const auto found = rank_correlation(a, b, {.draws = 300, .seed = sample});
    ASSERT_TRUE(found);
    held += *found->ci95.low <= truth && truth <= *found->ci95.high ? 1 : 0;
  }
  EXPECT_GE(held, 52) << "95 % of 60 are 57, three standard errors 5";
  EXPECT_LT(held, samples) << "intervals without an end would hold everything";
}

TEST(RankCorrelation, RejectsListsWithoutARanking) {
  const std::vector<double> four{1, 2, 3, 4}, five{1, 2, 3, 4, 5}, equal{2, 2, 2, 2};
  const std::vector<double> infinite{1, 2, 3, std::numeric_limits<double>::infinity()};

  EXPECT_FALSE(rank_correlation(four, five));
  EXPECT_FALSE(rank_correlation(std::span(four).first(3), std::span(four).first(3)));
  EXPECT_FALSE(rank_correlation(four, equal));
  EXPECT_FALSE(rank_correlation(four, infinite));
}

}  // namespace
}  // namespace todbench
