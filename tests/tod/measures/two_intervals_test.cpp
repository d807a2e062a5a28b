// SPDX-License-Identifier: GPL-3.0-or-later
#include "tod/measures/two_intervals.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "acquisition/base/rng.h"

namespace todbench {
namespace {

double below_normal(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

constexpr double z75 = 0.6744897501960817;

/// Normal scores of sd 1 about `mean`.
IntervalScores normal_scores(double mean, std::size_t rows, std::size_t draws, std::uint64_t stream) {
  const RandomStream random(5, stream);
  IntervalScores scores(rows, std::vector<float>(draws));
  std::uint64_t n = 0;
  for (auto& row : scores)
    for (float& one : row) one = static_cast<float>(mean) + random.normal(n++);
  return scores;
}

TEST(ShareOfPairs, CountsEveryPairExceptThoseOfOneDraw) {
  const IntervalScores pattern{{1, 3}, {2, 2}}, other{{2, 0}, {5, 2}};

  const ShareOfPairs share = share_of_pairs(pattern, other);

  // Draw 1 against 2: 1 > 0, 1 < 2, 2 > 0, 2 = 2; draw 2 against 1: 3 > 2, 3 < 5, 2 = 2, 2 < 5.
  EXPECT_DOUBLE_EQ(share.mean, 4.0 / 8);
}

TEST(ShareOfPairs, IsTheClosedFormOfNormalScoresWithinItsError) {
  for (const double distance : {0.3, 0.9539, 2.0}) {
    const ShareOfPairs share = share_of_pairs(normal_scores(distance, 4, 500, 1), normal_scores(0, 4, 500, 2));

    EXPECT_NEAR(share.mean, below_normal(distance / std::numbers::sqrt2), 4 * share.standard_error) << distance;
    // 2000 scores on each side: sqrt((1 / 12) (2 / 2000)) = 0.0091 at chance, less with distance.
    EXPECT_LT(share.standard_error, 0.013);
    EXPECT_GT(share.standard_error, 0.001);
  }
}

TEST(FitContrast, FindsTheFunctionThatMadeTheShares) {
  std::vector<ContrastShare> shares;
  for (const double phase : {-0.4, -0.2, 0.0, 0.1, 0.3}) {
    for (const double contrast : {0.01, 0.02, 0.04, 0.08, 0.16}) {
      const double angle = 2 * std::numbers::pi * phase;
      const double threshold = 0.035 / std::sqrt(1 - 0.6 * std::cos(angle) + 0.3 * std::sin(angle));
      shares.push_back({contrast, below_normal(z75 * std::pow(contrast / threshold, 1.7)), phase});
    }
  }

  const auto found = fit_contrast(shares, 0.05, PhaseFit::swing);

  ASSERT_TRUE(found);
  EXPECT_NEAR(found->level_k, 0.035, 1e-6);
  EXPECT_NEAR(found->exponent, 1.7, 1e-4);
  EXPECT_NEAR(found->swing[0], -0.6, 1e-4);
  EXPECT_NEAR(found->swing[1], 0.3, 1e-4);
  // The energy 1 - 0.6 cos a + 0.3 sin a is largest where tan a = -1/2: 1 + sqrt(0.45).
  EXPECT_NEAR(found->best_phase(), std::atan2(0.3, -0.6) / (2 * std::numbers::pi), 1e-4);
  EXPECT_NEAR(found->ln_ratio_at(found->best_phase()), -0.5 * std::log(1 + std::sqrt(0.45)), 1e-4);
}

TEST(FitContrast, FindsNoThresholdWhereNoneIs) {
  std::vector<ContrastShare> chance;
  for (const double contrast : {0.01, 0.02, 0.04, 0.08}) chance.push_back({contrast, 0.5, 0});

  EXPECT_FALSE(fit_contrast(chance, 0.02));
  EXPECT_FALSE(fit_contrast({chance.data(), 1}, 0.01));
}

}  // namespace
}  // namespace todbench
