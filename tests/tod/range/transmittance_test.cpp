// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of transmittance, and the range of a TOD curve behind them.
#include "tod/range/transmittance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tod/range/criterion_range.h"
#include "tod/range/range_prediction.h"

namespace todbench {
namespace {

using Rows = std::vector<TransmittancePoint>;

Rows exponential_rows(double extinction_per_km, double end_m) {
  Rows rows;
  for (double range_m = 10; range_m < end_m; range_m *= 2)
    rows.push_back({range_m, std::exp(-extinction_per_km * range_m / 1000)});
  rows.push_back({end_m, std::exp(-extinction_per_km * end_m / 1000)});
  return rows;
}

TEST(TransmittanceTable, IsRightAtItsRowsAndAnExponentialOneEverywhere) {
  const auto air = Transmittance::of_table(exponential_rows(0.4, 9000));

  ASSERT_TRUE(air) << air.error().message;
  // One rounding of tau near 1 (1e-16 of a depth of 4e-3) is carried to the ends by the power: 1e-12.
  for (const double range_m : {0.5, 10.0, 33.0, 1234.5, 8999.0, 9000.0})
    EXPECT_NEAR(air->optical_depth(range_m).value() / (0.4 * range_m / 1000), 1, 1e-12);
  EXPECT_FALSE(air->at(9000.1));
  EXPECT_EQ(air->at(0), 1.0);
  EXPECT_EQ(air->end_m(), 9000);
}

TEST(TransmittanceTable, IsMonotoneBetweenAnyRowsAndGoesToOne) {
  const auto air = Transmittance::of_table(Rows{{0, 1}, {100, 1}, {200, 0.99}, {300, 0.99}, {5000, 0.2}, {9000, 0}});

  ASSERT_TRUE(air) << air.error().message;
  EXPECT_EQ(air->end_m(), 5000) << "a transmittance of 0 is a program's floor";
  double before = 1;
  for (double range_m = 1; range_m <= 5000; range_m += 7) {
    const double tau = air->at(range_m).value();
    EXPECT_LE(tau, before);
    before = tau;
  }
}

TEST(TransmittanceTable, RefusesInOneSentence) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Rows& rows : {Rows{}, Rows{{100, 0.9}}, Rows{{100, 0.9}, {100, 0.8}}, Rows{{200, 0.9}, {100, 0.95}},
                           Rows{{100, 0.9}, {200, 0.95}}, Rows{{100, 1.1}, {200, 0.9}}, Rows{{100, 0.9}, {200, -0.1}},
                           Rows{{100, nan}, {200, 0.9}}, Rows{{nan, 0.9}, {200, 0.8}}, Rows{{-1, 0.9}, {200, 0.8}},
                           Rows{{0, 0.9}, {200, 0.8}}, Rows{{100, 0.9}, {200, 0}}}) {
    const auto air = Transmittance::of_table(rows);
    ASSERT_FALSE(air.has_value());
    EXPECT_EQ(air.error().code, ErrorCode::invalid_input);
    EXPECT_FALSE(air.error().message.empty());
  }
}

TEST(TransmittanceSpectrum, IsTheMeanOfExponentials) {
  const auto air = Transmittance::of_spectrum({1, 3}, {2, 0.5});

  for (const double range_m : {0.0, 1.0, 700.0, 5000.0}) {
    const double expected = (std::exp(-2 * range_m / 1000) + 3 * std::exp(-0.5 * range_m / 1000)) / 4;
    EXPECT_NEAR(air.at(range_m).value() / expected, 1, 1e-13);
  }
  // Far out the clearest wavelength alone: ln(4 / 3) more than its depth.
  EXPECT_NEAR(air.optical_depth(1e7).value(), 5000 + std::log(4.0 / 3), 1e-9);
}

TEST(RangeBehindAir, AnExponentialTableReproducesTheExtinction) {
  const std::vector<TodThreshold> tod{{0.01, 6, {5, 7}}, {1, 2, {1.9, 2.1}}, {10, 1.5, {1.4, 1.6}}};
  RangeTask task{.size_m = 5, .delta_t_k = 4, .extinction_per_km = 0.6};

  const auto plain = predict_range(tod, task);
  task.air = *Transmittance::of_table(exponential_rows(0.6, 20000));
  task.extinction_per_km = 0;
  const auto tabulated = predict_range(tod, task);

  ASSERT_TRUE(plain && tabulated);
  EXPECT_NEAR(*tabulated->r75_m / *plain->r75_m, 1, 1e-12);
  EXPECT_NEAR(*tabulated->r75_ci95_m.low / *plain->r75_ci95_m.low, 1, 1e-12);
  EXPECT_NEAR(*tabulated->r75_ci95_m.high / *plain->r75_ci95_m.high, 1, 1e-12);
  ASSERT_EQ(tabulated->curve.size(), plain->curve.size());
}

TEST(RangeBehindAir, ClearAirIsNoAirBitForBit) {
  const std::vector<TodThreshold> tod{{0.01, 6, {5, 7}}, {10, 1.5, {1.4, 1.6}}};
  RangeTask task{.size_m = 5, .delta_t_k = 4};

  const auto without = predict_range(tod, task);
  task.air = Transmittance::beer_lambert(0);
  const auto clear = predict_range(tod, task);

  ASSERT_TRUE(without && clear);
  EXPECT_EQ(without->r75_m, clear->r75_m);
  EXPECT_EQ(without->r75_ci95_m.low, clear->r75_ci95_m.low);
  EXPECT_EQ(without->curve.back().probability, clear->curve.back().probability);
}

TEST(RangeBehindAir, ATargetOfTheLowestContrastHasNeitherRangeNorBound) {
  const std::vector<TodThreshold> single{{0.5013647232896002, 2.58, {2.54, 2.62}}};
  // With these contrasts, the logarithms differ by 0 or by a rounding error.
  for (const double delta_t_k : {0.5, 0.5013647232896002, std::nextafter(0.5013647232896002, 1.0)}) {
    for (const Transmittance& air :
         {Transmittance::beer_lambert(0.2), *Transmittance::of_table(Rows{{100, 0.9}, {5000, 0.5}})}) {
      RangeTask task{.size_m = 2, .delta_t_k = delta_t_k};
      task.air = air;

      const auto found = predict_range(single, task);

      ASSERT_TRUE(found);
      EXPECT_FALSE(found->r75_m || found->r75_ci95_m.low) << delta_t_k;
      EXPECT_NE(found->reason.find("lowest contrast"), std::string::npos) << found->reason;
      const auto of_criterion = range_for_probability(
          [](double contrast) { return contrast < 0.5013647232896002 ? std::nullopt : std::optional(0.4); },
          {2, task.delta_t_k}, air, {.at_half = 1, .form = ProbabilityForm::johnson}, 0.75);
      EXPECT_FALSE(of_criterion.range_m || of_criterion.at_least_m) << delta_t_k;
    }
  }
}

TEST(RangeBehindAir, ATableThatEndsBeforeTheRangeGivesALowerLimit) {
  const std::vector<TodThreshold> tod{{0.01, 6, {5, 7}}, {10, 1.5, {1.4, 1.6}}};
  RangeTask task{.size_m = 5, .delta_t_k = 4};
  task.air = *Transmittance::of_table(Rows{{10, 0.99}, {50, 0.98}});

  const auto found = predict_range(tod, task);

  ASSERT_TRUE(found) << found.error().message;
  EXPECT_FALSE(found->r75_m);
  EXPECT_NE(found->reason.find("at 50 m, the end of the table"), std::string::npos) << found->reason;
  EXPECT_DOUBLE_EQ(found->r75_ci95_m.low.value(), 50);
}

TEST(RangeBehindAir, RefusesAnExtinctionBesideATable) {
  RangeTask task{.size_m = 5, .delta_t_k = 4, .extinction_per_km = 0.1};
  task.air = Transmittance::beer_lambert(0.2);

  EXPECT_FALSE(predict_range(std::vector<TodThreshold>{{10, 1.5, {1.4, 1.6}}}, task).has_value());
}

}  // namespace
}  // namespace todbench
