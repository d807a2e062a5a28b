// SPDX-License-Identifier: GPL-3.0-or-later
// Transfer of a TOD curve to frequencies of bars.
#include "tod/range/tod_transfer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace todbench {
namespace {

using ::testing::HasSubstr;

const TodTransfer transfer{.name = "test-1",
                           .observer = "hvs-1",
                           .source = "a test",
                           .ln_low = std::log(3),
                           .ln_high = std::log(1.5),
                           .ln_centre = std::log(0.8),
                           .ln_width = 0.2,
                           .least = 0.25,
                           .asymptote_over_noise = 60,
                           .half_width_ln = 0.1};

TEST(TodTransfer, IsASigmoidBetweenBothLevels) {
  EXPECT_NEAR(transfer_factor(transfer, 1e-6), 3, 1e-9);
  EXPECT_NEAR(transfer_factor(transfer, 0.8), std::sqrt(3 * 1.5), 1e-12);
  EXPECT_NEAR(transfer_factor(transfer, 1e6), 1.5, 1e-9);
}

TEST(TodTransfer, GivesFrequenciesWithTheIntervalsOfTheThresholds) {
  const std::vector<TodThreshold> curve{{0.2, 5, {4.5, 5.5}}, {10, 2, {1.9, {}}}};
  const auto found = transferred(curve, transfer, 0.07);

  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->points.size(), 2U);
  const TodThreshold &low = found->points.front(), &high = found->points.back();
  EXPECT_EQ(low.delta_t_k, 0.2);
  EXPECT_NEAR(1 / low.s75_mrad, 0.2 * transfer_factor(transfer, 0.4), 1e-12);
  const double own = std::log(transfer_factor(transfer, 2 / 4.5) / 4.5 * low.s75_mrad);
  const double of_asymptote = std::log(transfer_factor(transfer, 1.9 / 5) / 5 * low.s75_mrad);
  EXPECT_NEAR(std::log(low.s75_mrad / *low.s75_ci95_mrad.low), std::hypot(own, of_asymptote), 1e-12);
  EXPECT_FALSE(low.s75_ci95_mrad.high) << "the asymptote is open on this side";
  EXPECT_NEAR(1 / high.s75_mrad, transfer_factor(transfer, 1) / 2, 1e-12);
  EXPECT_NEAR(1 / *high.s75_ci95_mrad.low, transfer_factor(transfer, 1) / 1.9, 1e-12);
  EXPECT_FALSE(high.s75_ci95_mrad.high);
}

TEST(TodTransfer, EndsWhereItWasStudied) {
  const std::vector<TodThreshold> curve{{0.05, 9, {8, 10}}, {0.2, 5, {4.5, 5.5}}, {10, 2, {1.9, 2.1}}};
  const auto without = transferred(curve, transfer, 0.07);

  ASSERT_TRUE(without);
  EXPECT_EQ(without->points.size(), 2U);
  ASSERT_EQ(without->notes.size(), 1U);
  EXPECT_THAT(without->notes.front(), HasSubstr("at 0.05 K"));
  const auto early = transferred(curve, transfer, 0.2);
  ASSERT_FALSE(early) << "10 K is 50 times the noise: the curve still rises";
  EXPECT_THAT(early.error().message, HasSubstr("12 K"));
  EXPECT_FALSE(transferred({}, transfer, 0.07));
  EXPECT_FALSE(transferred(curve, transfer, 0));
}

TEST(TodTransfer, PublishedOnesAreKnownByNameAndRiseWithTheAcuity) {
  for (const TodTransfer& one : tod_transfers()) {
    EXPECT_EQ(tod_transfer_named(one.name).value().source, one.source);
    EXPECT_GT(one.half_width_ln, 0);
    double before = 0;
    for (double place = one.least; place <= 1.05; place += 0.01) {
      EXPECT_GE(place * transfer_factor(one, place), before) << one.name << " " << place;
      before = place * transfer_factor(one, place);
    }
  }
  const auto unknown = tod_transfer_named("fraunhofer");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("simulated-imagers-1"));
}

}  // namespace
}  // namespace todbench
