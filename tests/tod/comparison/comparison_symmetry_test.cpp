// SPDX-License-Identifier: GPL-3.0-or-later
// A comparison says the same of two curves in either order, and nothing of numbers that are not fit for it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tod/adequacy/adequacy_support.h"
#include "tod/comparison/comparison.h"

namespace todbench {
namespace {

using testing::AdequacyDesign;
using testing::drawn;

TodPoint point_of(double set_delta_t_k, const AdequacyDesign& design, const RandomStream& stream) {
  TodPoint point;
  point.set_delta_t_k = point.delta_t_k = set_delta_t_k;
  point.levels = drawn(design, stream);
  point.fit = fit_psychometric(point.levels, {.with_posterior = false}).value();
  return point;
}

void expect_inverse(const Interval& forth, const Interval& back) {
  ASSERT_EQ(forth.low.has_value(), back.high.has_value());
  ASSERT_EQ(forth.high.has_value(), back.low.has_value());
  if (forth.low) {
    EXPECT_NEAR(*forth.low * *back.high, 1, 1e-9);
  }
  if (forth.high) {
    EXPECT_NEAR(*forth.high * *back.low, 1, 1e-9);
  }
}

TEST(ComparisonSymmetry, ExchangedCurvesGiveInverseRatiosAndTheSameVerdicts) {
  for (std::uint64_t pair = 0; pair < 60; ++pair) {
    const RandomStream stream = RandomStream(21, "pairs").sub(pair);
    // Few trials and many, clustered and not, equal contrasts and those that are only nearly equal, some missing.
    TodCurve a{"o", "a", {}}, b{"o", "b", {}};
    for (std::uint64_t i = 0; i < 3; ++i) {
      const RandomStream own = stream.sub(i);
      const auto design = [&](std::uint64_t at) {
        return AdequacyDesign{.trials_per_size = static_cast<int>(2 + own.below(60, at)),
                              .slope = 2 + 3 * own.uniform(at + 1),
                              .clusters = own.uniform(at + 2) < 0.3 ? 6 : 0,
                              .cluster_sd = 0.1};
      };
      const double contrast = 4 / (1.0 + static_cast<double>(i));
      a.points.push_back(point_of(contrast, design(10), own.sub(1)));
      if (own.uniform(50) < 0.8) b.points.push_back(point_of(contrast * 1.003, design(20), own.sub(2)));
      if (own.uniform(51) < 0.3) b.points.push_back(point_of(contrast * 0.998, design(30), own.sub(3)));
    }
    const auto forth = compare(a, b, {}), back = compare(b, a, {});

    ASSERT_EQ(forth.has_value(), back.has_value());
    if (!forth) continue;
    EXPECT_EQ(forth->verdict, back->verdict);
    ASSERT_EQ(forth->points.size(), back->points.size());
    for (const ComparisonPoint& one : forth->points) {
      const auto other = std::find_if(back->points.begin(), back->points.end(), [&](const ComparisonPoint& p) {
        return p.delta_t_a_k == one.delta_t_b_k && p.delta_t_b_k == one.delta_t_a_k;
      });
      ASSERT_NE(other, back->points.end());
      EXPECT_EQ(one.verdict, other->verdict);
      ASSERT_EQ(one.ratio.has_value(), other->ratio.has_value());
      if (one.ratio) {
        EXPECT_NEAR(*one.ratio * *other->ratio, 1, 1e-12);
      }
      expect_inverse(one.ratio_ci95, other->ratio_ci95);
      expect_inverse(one.ratio_ci90, other->ratio_ci90);
      ASSERT_EQ(one.p_difference.has_value(), other->p_difference.has_value());
      if (one.p_difference) {
        EXPECT_NEAR(*one.p_difference, *other->p_difference, 1e-6);
      }
    }
  }
}

TEST(ComparisonAdequacy, TheSameAnswersAreNotEquivalent) {
  const TodCurve curve{"o", "s", {point_of(1, {.trials_per_size = 1000}, RandomStream(1, "same"))}};

  const auto compared = compare(curve, curve, {});

  ASSERT_TRUE(compared);
  EXPECT_EQ(compared->verdict, ComparisonVerdict::inconclusive);
  ASSERT_TRUE(compared->adequacy);
  EXPECT_FALSE(compared->adequacy->adequate());
  EXPECT_EQ(compared->adequacy->findings.front().kind, FindingKind::identity);
}

TEST(ComparisonAdequacy, AThresholdThatIsUnfitLeavesItsContrastInconclusiveInEitherOrder) {
  const TodCurve good{"o", "g", {point_of(1, {.trials_per_size = 1000}, RandomStream(1, "good"))}};
  TodCurve bad{"o", "b", {point_of(1, {.trials_per_size = 1000}, RandomStream(2, "bad"))}};
  ASSERT_EQ(compare(good, bad, {.margin_percent = 50, .fit = {}})->verdict, ComparisonVerdict::equivalent);
  bad.points.front().adequacy = Adequacy{{{FindingKind::clipping, 0.5, 0, "pixels are saturated", true}}};

  for (const auto& compared :
       {compare(good, bad, {.margin_percent = 50, .fit = {}}), compare(bad, good, {.margin_percent = 50, .fit = {}})}) {
    EXPECT_EQ(compared->verdict, ComparisonVerdict::inconclusive);
    EXPECT_NE(reasons_unfit(*compared->adequacy).find("pixels are saturated"), std::string::npos);
    Comparison paired = *compared;
    add_paired(paired, 0, {.ratio = 1, .verdict = ComparisonVerdict::equivalent});
    EXPECT_EQ(paired.verdict, ComparisonVerdict::inconclusive);
  }
}

}  // namespace
}  // namespace todbench
