// SPDX-License-Identifier: GPL-3.0-or-later
// Optics of a camera from its own pictures, against sensors whose optics are known.
#include "tests/sim_devices/prediction/optics_sessions.h"

namespace todbench::test {
namespace {

TEST(CameraOptics, OfACameraWithMoreBlurAreFoundTogetherWithItsFNumber) {
  const SensorSpec camera = sensor_with([](SensorSpec& s) { s.f_number = 1.5, s.aberration_sigma_pitch = 0.35; });

  const auto found = OpticsSessions({.camera = camera}).fitted(SensorSpec{}, 1);

  ASSERT_TRUE(found);
  EXPECT_TRUE(found->differs);
  EXPECT_TRUE(found->optics.fits()) << found->optics.chi2;
  // Five standard errors; sigma has 0.0005 and the f-number 0.008 at this noise.
  EXPECT_NEAR(found->optics.aberration_sigma_pitch, 0.35, 5 * 0.0006);
  EXPECT_NEAR(found->optics.f_number_ratio, 1.5, 5 * 0.009);
}

TEST(CameraOptics, OfASlowerLensAreNoGaussianBlur) {
  const SensorSpec camera = sensor_with([](SensorSpec& s) { s.f_number = 2; });

  const auto found = OpticsSessions({.camera = camera}).fitted(SensorSpec{}, 2);

  ASSERT_TRUE(found);
  EXPECT_NEAR(found->optics.f_number_ratio, 2, 5 * 0.006);
  // Sigma squared has a standard error of 1e-4 pitch^2.
  EXPECT_LT(found->optics.aberration_sigma_pitch, 0.03);
  EXPECT_TRUE(found->optics.fits()) << found->optics.chi2;
}

TEST(CameraOptics, OfACameraLikeItsTwinDoNotDiffer) {
  const OpticsSessions sessions({});
  for (const std::uint64_t seed : {11, 12}) {
    const auto found = sessions.fitted(SensorSpec{}, seed);

    ASSERT_TRUE(found);
    EXPECT_FALSE(found->differs) << seed;
    EXPECT_TRUE(found->optics.fits()) << found->optics.chi2;
  }
}

TEST(CameraOptics, FitDespiteFixedPatternAndReplacedPixels) {
  const SensorSpec camera = sensor_with([](SensorSpec& s) { s.fixed_pattern_k = 0.1; });

  const auto found = OpticsSessions({.camera = camera, .dead_share = 0.005}).fitted(SensorSpec{}, 3);

  ASSERT_TRUE(found);
  EXPECT_FALSE(found->differs) << found->optics.twin_statistic;
  EXPECT_TRUE(found->optics.fits()) << found->optics.chi2;
  // The blocks between the triangles have 5000 pixels: 1 % of the pattern.
  EXPECT_NEAR(found->optics.fixed_pattern_k, 0.1, 0.005);
}

TEST(CameraOptics, AreFoundFromTwinsThatAreFarOff) {
  const auto midwave = [](SensorSpec& s) {
    s.pitch_um = 15, s.detector_um = 13.5, s.focal_length_mm = 15 / (47.5 / 36.3);
    s.f_number = 4, s.wavelength_min_um = 3, s.wavelength_max_um = 5, s.netd_k = 0.03;
  };
  struct Pair {
    double twin_sigma, camera_sigma, ratio;
    bool is_midwave;
  };
  for (const Pair& pair : {Pair{0, 0.6, 1, true},
                           {0, 0.6, 0.6, true},
                           {0.8, 0, 1, true},
                           {0, 0.9, 1.9, false},
                           {0.9, 0.1, 0.7, false},
                           {0.4, 0.7, 1.5, true}}) {
    const SensorSpec twin = sensor_with([&](SensorSpec& s) {
      if (pair.is_midwave) midwave(s);
      s.aberration_sigma_pitch = pair.twin_sigma;
    });
    SensorSpec camera = twin;
    camera.aberration_sigma_pitch = pair.camera_sigma, camera.f_number *= pair.ratio;
    const auto found = OpticsSessions({.camera = camera}).fitted(twin, 7);

    ASSERT_TRUE(found) << pair.twin_sigma << " " << pair.camera_sigma << " " << pair.ratio;
    EXPECT_TRUE(found->optics.fits()) << found->optics.chi2;
    const double variance_se =
        2 * std::max(0.02, found->optics.aberration_sigma_pitch) * found->optics.aberration_se_pitch;
    EXPECT_NEAR(std::pow(found->optics.aberration_sigma_pitch, 2), std::pow(pair.camera_sigma, 2),
                5 * variance_se + 1e-3);
    EXPECT_NEAR(found->optics.f_number_ratio, pair.ratio, 5 * found->optics.f_number_ratio_se + 2e-3);
  }
}

TEST(CameraOptics, OfNoLensOfTheTwinsKindAreRefused) {
  const auto halo = OpticsSessions({.halo_share = 0.05}).fitted(SensorSpec{}, 4);
  const auto larger = OpticsSessions({.size_ratio = 1.003}).fitted(SensorSpec{}, 4);

  ASSERT_TRUE(halo);
  ASSERT_TRUE(larger);
  EXPECT_FALSE(halo->optics.fits()) << halo->optics.chi2 << " of " << halo->optics.chi2_limit;
  EXPECT_FALSE(larger->optics.fits()) << larger->optics.chi2 << " of " << larger->optics.chi2_limit;
}

}  // namespace
}  // namespace todbench::test
