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
