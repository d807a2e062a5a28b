// SPDX-License-Identifier: GPL-3.0-or-later
// Ranges where the target line never meets the TOD curve, or meets it at the edge of what is known.
#include <gtest/gtest.h>

#include <cmath>

#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

const std::vector<TodThreshold> curve{{16.9, 1.5, {1.4, 1.6}}, {1.93, 1.8, {1.7, 1.9}}, {0.23, 2.6, {2.4, 2.8}}};

void expect_finite(const RangePrediction& prediction) {
  for (const auto& value : {prediction.r75_m, prediction.r75_ci95_m.low, prediction.r75_ci95_m.high}) {
    if (value) {
      EXPECT_TRUE(std::isfinite(*value));
    }
  }
  for (const RangePoint& point : prediction.curve) {
    EXPECT_TRUE(std::isfinite(point.range_m));
    EXPECT_TRUE(std::isfinite(point.apparent_delta_t_k));
    if (point.probability) {
      EXPECT_TRUE(*point.probability >= 0 && *point.probability <= 1);
    }
  }
}

// Hard: the contrast at the target is already below the lowest threshold: no range solves the equation, and an
// extrapolated one would be made up.
TEST(RangeLimits, ATargetBelowTheLowestContrastHasNoRangeAndAReason) {
  for (const double contrast : {0.2299, 0.01, 1e-12, 1e-300}) {
    const auto found = predict_range(curve, {.size_m = 5, .delta_t_k = contrast});

    ASSERT_TRUE(found) << found.error().message;
    EXPECT_FALSE(found->r75_m) << contrast;
    EXPECT_FALSE(found->reason.empty());
    expect_finite(*found);
  }
}

// Hard: the air takes the contrast below the lowest threshold before the target is small enough to reach M75.
TEST(RangeLimits, ATargetThatTheAirHidesBeforeItIsTooSmallHasNoRange) {
  // Known down to exp(-k R) = 0.23 / 1: R = 15 m at 100 per km; there M is still 1000 * 5 / 15 / 2.6 = 128.
  const auto found = predict_range(curve, {.size_m = 5, .delta_t_k = 1, .extinction_per_km = 100});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->r75_m);
  EXPECT_FALSE(found->reason.empty());
  expect_finite(*found);
}

// Hard: exp(-k R) underflows, or R spans twenty decades. Without air the answer stays closed: 1000 L / (S75 M75).
TEST(RangeLimits, TinyAndHugeTargetsKeepTheClosedAnswer) {
  for (const double size : {1e-9, 1e-3, 5.0, 1e6}) {
    const auto found = predict_range(curve, {.size_m = size, .delta_t_k = 16.9});

    ASSERT_TRUE(found) << found.error().message;
    ASSERT_TRUE(found->r75_m) << size << ": " << found->reason;
    EXPECT_NEAR(*found->r75_m / (1000 * size / 1.5 / 5.1), 1, 1e-12) << size;
    expect_finite(*found);
  }
  const auto thick = predict_range(curve, {.size_m = 1e6, .delta_t_k = 16.9, .extinction_per_km = 1e6});
  ASSERT_TRUE(thick) << thick.error().message;
  expect_finite(*thick);
}

// Hard: the line touches the curve exactly at its last point.
TEST(RangeLimits, ATargetExactlyAtTheLowestContrastHasTheRangeOfThatThreshold) {
  const auto found = predict_range(curve, {.size_m = 5, .delta_t_k = 0.23});

  ASSERT_TRUE(found && found->r75_m);
  EXPECT_NEAR(*found->r75_m, 5000 / 2.6 / 5.1, 1e-9);
  expect_finite(*found);
}

}  // namespace
}  // namespace todbench
