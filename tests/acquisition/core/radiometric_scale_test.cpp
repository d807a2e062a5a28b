// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/radiometric_scale.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace todbench {
namespace {

std::vector<RadiometricScale> scales() {
  return {*RadiometricScale::linear({.kelvin_per_count = 0.04, .offset_k = 0}),
          *RadiometricScale::table({.counts = {1000, 3000, 8000}, .temperature_k = {280, 300, 340}}),
          *RadiometricScale::planck({.r = 366545, .b = 1428, .f = 1, .o = -342})};
}

TEST(RadiometricScale, KelvinAndCountsAreInverse) {
  for (const auto& scale : scales()) {
    for (double counts = 1500; counts < 7900; counts += 97) {
      const auto kelvin = scale.kelvin(counts);

      ASSERT_TRUE(kelvin.has_value()) << scale.describe();
      EXPECT_NEAR(*scale.counts(*kelvin), counts, 1e-9 * counts) << scale.describe();
    }
  }
}

TEST(RadiometricScale, SlopeIsTheDerivative) {
  for (const auto& scale : scales()) {
    const double h = 1e-2;

    const double slope = *scale.kelvin_per_count(5000);

    const double difference = (*scale.kelvin(5000 + h) - *scale.kelvin(5000 - h)) / (2 * h);
    EXPECT_NEAR(slope, difference, 1e-7 * slope) << scale.describe();
  }
}

TEST(RadiometricScale, SaysNothingWhereItDoesNotReach) {
  EXPECT_FALSE(RadiometricScale().kelvin(5000).has_value());
  EXPECT_FALSE(scales()[1].kelvin(999).has_value());
  EXPECT_FALSE(scales()[1].kelvin(8001).has_value());
  EXPECT_FALSE(scales()[2].kelvin(-342).has_value());
  EXPECT_FALSE(scales()[2].kelvin(std::numeric_limits<double>::quiet_NaN()).has_value());
}

TEST(RadiometricScale, RefusesNumbersThatAreNoScale) {
  EXPECT_EQ(RadiometricScale::linear({.kelvin_per_count = 0}).error().code, ErrorCode::calibration);
  EXPECT_EQ(RadiometricScale::table({.counts = {1, 1}, .temperature_k = {2, 3}}).error().code, ErrorCode::calibration);
  EXPECT_EQ(RadiometricScale::planck({.r = -1, .b = 1400}).error().code, ErrorCode::calibration);
}

}  // namespace
}  // namespace todbench
