// SPDX-License-Identifier: GPL-3.0-or-later
// The law of a camera's drift after a correction, against drifts that are known.
#include "tod/measures/drift_law.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "tests/tod/measures/drift_coverage.h"

namespace todbench {
namespace {

using testing::DriftCase;

TEST(DriftLaws, HoldTheDriftThatIsThere) {
  const DriftCase cases[] = {
      {}, {.time_constant_s = 6.0}, {.level_k = -0.3, .pattern_k = 0, .pixel_noise_k = 0.03}, {.frame_noise_k = 0}};
  constexpr int seeds = 30;
  for (const DriftCase& drift : cases) {
    const auto found = testing::drift_coverage(drift, seeds);
    ASSERT_EQ(found.seeds, seeds);
    // 30 seeds at 95 %: fewer than 24 come by chance once in 600.
    EXPECT_GE(found.level_within, 24.0 / seeds);
    EXPECT_GE(found.pattern_within, 24.0 / seeds);
    EXPECT_NEAR(found.level_error_k, 0, 0.5 * found.level_half_k);
    if (drift.time_constant_s) {
      EXPECT_GE(found.level_approaches, seeds - 2);
      EXPECT_EQ(found.pattern_approaches, seeds);
      EXPECT_GE(found.constant_within, 0.8);
    } else {
      // At 1 % of the test three of 30 come once in 300.
      EXPECT_LE(found.level_approaches, 3);
      EXPECT_LE(found.pattern_approaches, 3);
    }
  }
}

/// Of groups with few frames the mean is less certain: a host that was busy at the beginning and at the end makes no
/// pattern grow.
TEST(DriftLaws, FindNoGrowthInTheNoiseOfGroupsOfFewFrames) {
  constexpr int seeds = 30;
  int level = 0, pattern = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    auto groups = testing::drift_groups({.level_k = 0, .pattern_k = 0}, static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(groups.size());
    std::vector<float> draws(groups.front().mean_k.total());
    for (int k = 0; k < count; ++k) {
      DriftGroup& group = groups[static_cast<std::size_t>(k)];
      const bool few = k < 3 || k >= count - 3;
      group.frames = few ? 5 : 10;
      if (!few) continue;
      // Half the frames have twice the variance.
      RandomStream(static_cast<std::uint64_t>(seed), "test.few").sub(static_cast<std::uint64_t>(k)).fill_normal(draws);
      auto draw = draws.begin();
      for (double& value : group.mean_k) value += 0.015 * *draw++;
    }
    const auto law = drift_law(groups);
    ASSERT_TRUE(law) << law.error().message;
    level += law->level.change_ci95.low.value() <= 0 && 0 <= law->level.change_ci95.high.value() ? 1 : 0;
    pattern += law->pattern.change_ci95.low.value() <= 0 ? 1 : 0;
  }
  // 30 seeds at 95 %: fewer than 24 come by chance once in 600.
  EXPECT_GE(level, 24);
  EXPECT_GE(pattern, 24);
}

TEST(DriftLaws, SayWhatWasSeenAndFittedOfEachGroup) {
  const auto groups = testing::drift_groups({.pixel_noise_k = 1e-6, .frame_noise_k = 0}, 1);

  const auto law = drift_law(groups);

  ASSERT_TRUE(law) << law.error().message;
  EXPECT_EQ(law->level.shape, DriftShape::linear);
  ASSERT_EQ(law->time_s.size(), groups.size());
  ASSERT_EQ(law->pattern.seen_k.size(), groups.size());
  EXPECT_EQ(law->pattern.seen_k.front(), 0);
  // From 0.5 to 19.5 s of 20; the pattern as the standard deviation of 3072 draws.
  EXPECT_NEAR(law->pattern.fitted_k.back(), 0.03 * 0.95, 4 * 0.03 / std::sqrt(2 * 3072.0));
  EXPECT_NEAR(law->pattern.seen_k.back(), law->pattern.fitted_k.back(), 1e-4);
  EXPECT_NEAR(law->per_minute(law->level.change_k), 0.9, 0.03);
  for (std::size_t k = 0; k < groups.size(); ++k) EXPECT_NEAR(law->level.fitted_k[k], law->level.seen_k[k], 1e-5);
}

TEST(DriftLaws, RefuseWhatTellsNothing) {
  auto few = testing::drift_groups({.groups = 7}, 1);
  auto back = testing::drift_groups({}, 1), hole = back, other = back;
  back[5].time_s = back[4].time_s;
  hole[3].mean_k(2, 2) = std::numeric_limits<double>::quiet_NaN();
  other[3].mean_k = cv::Mat1d(40, 64, 300.0);
  auto still = testing::drift_groups({}, 1);
  for (DriftGroup& group : still) group.mean_k = cv::Mat1d(48, 64, 300.0);

  for (const auto* wrong : {&few, &back, &hole, &other}) {
    const auto law = drift_law(*wrong);
    ASSERT_FALSE(law);
    EXPECT_EQ(law.error().code, ErrorCode::invalid_input);
  }
  const auto law = drift_law(still);
  ASSERT_TRUE(law) << law.error().message;
  EXPECT_EQ(law->level.shape, DriftShape::linear);
  EXPECT_NEAR(law->level.change_k, 0, 1e-9);
  EXPECT_NEAR(law->pattern.change_k, 0, 1e-9);
}

}  // namespace
}  // namespace todbench
