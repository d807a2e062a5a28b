// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <cmath>
#include <limits>

#include "hvs/eye/contrast_sensitivity.h"
#include "hvs/eye/eye_optics.h"

namespace todbench {
namespace {

// Filter H at 20 points, computed by a second program from the equations alone.
constexpr double known_filter[][3] = {
    {1, 0.5, 75.2945153},   {1, 2, 141.836581},   {1, 8, 52.2599426},   {1, 20, 17.1504106},   {1, 40, 6.82960311},
    {10, 0.5, 79.3435059},  {10, 2, 224.965203},  {10, 8, 142.920463},  {10, 20, 49.276372},   {10, 40, 19.4526118},
    {50, 0.5, 80.2878876},  {50, 2, 261.491526},  {50, 8, 259.554166},  {50, 20, 97.642761},   {50, 40, 38.1914535},
    {300, 0.5, 80.8842342}, {300, 2, 290.034735}, {300, 8, 430.860509}, {300, 20, 182.509137}, {300, 40, 70.4812176}};

TEST(Eye, HasTheFilterOfItsEquations) {
  for (const auto& [luminance, frequency, expected] : known_filter) {
    const double found = std::sqrt(EyeFilter({}, luminance).detection_power(frequency));

    EXPECT_NEAR(found / expected, 1, 1e-8) << luminance << ' ' << frequency;  // nine digits are stated
  }
}

TEST(Eye, SeesGaborPatternsAsTheBandOfTheirSpectrum) {
  // The same integral by a rectangle rule of 400 x 400 points. Seven points for each axis leave up to 2e-3 where H
  // bends at frequency 0.
  EXPECT_NEAR(EyeFilter({}, 50).gabor_d_prime(4, 0.5) / 186.528506, 1, 1e-6);
  EXPECT_NEAR(EyeFilter({}, 10).gabor_d_prime(1, 1) / 179.551595, 1, 1e-5);
  EXPECT_NEAR(EyeFilter({}, 100).gabor_d_prime(16, 0.25) / 38.730731, 1, 1e-6);
}

TEST(Eye, NeedsMoreToDetectAmongManyChannels) {
  // Closed form for one channel: 84 % of 2AFC is sqrt(2) times the normal quantile 0.994458.
  EXPECT_NEAR(detection_d_prime(1), std::sqrt(2.0) * 0.9944578832, 1e-6);
  // The same probability integrated over the largest response without the pattern, by a second program. A prototype
  // states 3.25, 3.70 and 4.21, of which 3.70 is 0.08 dB of contrast too low.
  EXPECT_NEAR(detection_d_prime(100), 3.247315, 1e-5);
  EXPECT_NEAR(detection_d_prime(500), 3.733307, 1e-5);
  EXPECT_NEAR(detection_d_prime(3000), 4.210721, 1e-5);
}

TEST(Eye, HasAPupilBetweenTwoAndEightMillimetresThatLightCloses) {
  double before = 8;
  for (double luminance = 1e-3; luminance < 1e5; luminance *= 2) {
    const double pupil = pupil_diameter_mm(luminance, 30, 30);

    EXPECT_LT(pupil, before);
    EXPECT_GT(pupil, 2);
    before = pupil;
  }
}

TEST(Eye, ClosesThePupilWithAge) {
  EXPECT_LT(pupil_diameter_mm(10, 30, 70), pupil_diameter_mm(10, 30, 20));
}

TEST(Eye, PassesEverythingAtFrequencyZeroAndNothingBeyondDiffraction) {
  for (const double pupil : {2.0, 3.0, 5.0, 7.0}) {
    EXPECT_EQ(eye_mtf(0, pupil), 1);
    EXPECT_EQ(eye_mtf(diffraction_limit_per_degree(pupil), pupil), 0);
    EXPECT_EQ(eye_mtf(1e9, pupil), 0);
    for (double f = 0; f < 60; f += 1) EXPECT_LE(eye_mtf(f + 1, pupil), eye_mtf(f, pupil));
  }
}

TEST(Eye, IsMoreSensitiveInMoreLight) {
  for (const double frequency : {0.5, 2.0, 8.0, 20.0, 40.0}) {
    double before = 0;
    for (double luminance = 0.01; luminance < 1e4; luminance *= 3) {
      const double power = EyeFilter({}, luminance).detection_power(frequency);

      EXPECT_GT(power, before) << luminance << ' ' << frequency;
      before = power;
    }
  }
}

TEST(Eye, DoesNotSeeAFlatField) {
  EXPECT_EQ(EyeFilter({}, 50).detection_power(0), 0);
}

TEST(Eye, RefusesParametersOutOfRange) {
  EXPECT_TRUE(validate(EyeParameters{}));
  EXPECT_FALSE(validate(EyeParameters{.sensitivity = 0}));
  EXPECT_FALSE(validate(EyeParameters{.uncertainty_channels = 0.5}));
  EXPECT_FALSE(validate(EyeParameters{.contrast_noise = -1}));
  EXPECT_FALSE(validate(EyeParameters{.age_years = std::numeric_limits<double>::quiet_NaN()}));
}

}  // namespace
}  // namespace todbench
