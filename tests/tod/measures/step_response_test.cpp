// SPDX-License-Identifier: GPL-3.0-or-later
// The time constant of steps, against time constants that are known.
#include "tod/measures/step_response.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/tod/measures/step_coverage.h"

namespace todbench {
namespace {

using testing::StepCase;

TEST(StepResponses, HoldTheTimeConstantWhateverTheExposure) {
  const StepCase cases[] = {
      {},
      {.exposure_s = 0.02, .noise_k = 0.01},
      {.time_constant_s = 0.012, .exposure_s = 0.004, .correlation = 0.5},
      {.time_constant_s = 0.05, .noise_k = 0.02},
      {.time_constant_s = 0.012, .target_s = 0.0005, .settling_s = 0.005},
  };
  constexpr int seeds = 20;
  for (const StepCase& one : cases) {
    const auto found = testing::step_coverage(one, seeds);
    EXPECT_EQ(found.told, seeds) << one.time_constant_s;
    // 20 seeds at 95 %: fewer than 15 come by chance once in 3000.
    EXPECT_GE(found.within, 15.0 / seeds) << one.time_constant_s;
    EXPECT_LT(std::abs(found.mean_error), found.half_width) << one.time_constant_s;
    EXPECT_LT(found.half_width, 0.1) << one.time_constant_s;
  }
}

TEST(StepResponses, OfNoNoiseAreTheTruth) {
  const StepCase one{.exposure_s = 0.015, .noise_k = 1e-6};

  const auto found = step_response(testing::step_series(one, 1), {.frame_s = one.frame_s});

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->both.value_s, 0.01, 1e-6);
  EXPECT_EQ(found->both.steps, 16);
  ASSERT_TRUE(found->rise && found->fall);
  EXPECT_NEAR(found->rise->value_s, 0.01, 1e-6);
  EXPECT_EQ(found->fall->steps, 8);
  ASSERT_EQ(found->points.size(), static_cast<std::size_t>(found->samples));
  for (const StepPoint& point : found->points) EXPECT_NEAR(point.left, std::exp(-point.time_s / 0.01), 1e-5);
}

TEST(StepResponses, RefuseWhatTellsNoTimeConstant) {
  const StepCase at_once{.time_constant_s = 1e-4};
  const StepCase slow{.time_constant_s = 0.4};
  const StepCase noisy{.step_k = 0.01};
  // A target that needs longer than it says, and one whose stated settling is longer than the camera's.
  const StepCase late{.time_constant_s = 0.012, .target_s = 0.03};
  const StepCase covered{.time_constant_s = 0.012, .target_s = 0.02, .settling_s = 0.14};
  for (const StepCase* one : {&at_once, &slow, &noisy, &late, &covered}) {
    const auto found =
        step_response(testing::step_series(*one, 1), {.frame_s = one->frame_s, .settling_s = one->settling_s});
    ASSERT_FALSE(found) << one->time_constant_s << " " << one->target_s;
    EXPECT_EQ(found.error().code, ErrorCode::calibration);
  }
}

TEST(StepResponses, RefuseSamplesThatCannotBeFitted) {
  const StepCase one;
  const auto steps = testing::step_series(one, 1);
  auto back = steps, hole = steps, cut = steps;
  back[3].time_s[9] = back[3].time_s[8];
  hole[3].signal[9] = std::numeric_limits<double>::quiet_NaN();
  cut[3].signal.resize(10), cut[3].time_s.resize(10);
  std::vector<StepSeries> few(steps.begin(), steps.begin() + 3);
  for (const auto* wrong : {&back, &hole, &cut, &few}) {
    const auto found = step_response(*wrong, {.frame_s = one.frame_s});
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::invalid_input);
  }
  EXPECT_FALSE(step_response(steps, {.frame_s = 0}));
  EXPECT_FALSE(step_response(steps, {.frame_s = 0.02, .settling_s = -1}));
}

}  // namespace
}  // namespace todbench
