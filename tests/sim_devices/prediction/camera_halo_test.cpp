// SPDX-License-Identifier: GPL-3.0-or-later
// The halo of a camera from its own pictures, against sensors whose halo is known.
#include "tests/sim_devices/prediction/camera_halos.h"

namespace todbench::test {
namespace {

TEST(CameraHaloFit, FindsTheShareOfAHalo) {
  for (const auto& [share, sigma] : {std::pair(0.03, 8.0), {0.01, 8.0}, {0.1, 14.0}}) {
    const SensorSpec camera = camera_with_halo(share, sigma);

    const auto found = OpticsSessions({.camera = camera}).halo(SensorSpec{}, 1);

    ASSERT_TRUE(found) << share << " at " << sigma;
    // The widths that are tried differ by a factor of 1.5: a fifth of the share.
    EXPECT_NEAR(found->share, share, 0.2 * share + 3 * found->share_se) << sigma;
    EXPECT_LT(std::abs(std::log(found->sigma_px / sigma)), std::log(1.6));
  }
}

TEST(CameraHaloFit, FindsNoneInCamerasWithout) {
  for (const HaloCamera& one : cameras_without_halo()) {
    const OpticsSessions sessions({.camera = one.camera});
    EXPECT_FALSE(sessions.halo(one.twin, 1, one.f_number_ratio)) << one.name;
  }
}

TEST(CameraHaloFit, KnowsTheHaloOfTheTwin) {
  const SensorSpec twin = camera_with_halo(0.05, 8);

  EXPECT_FALSE(OpticsSessions({.camera = twin}).halo(twin, 1));
  const auto without = OpticsSessions({.camera = SensorSpec{}}).halo(twin, 1);
  ASSERT_TRUE(without);
  EXPECT_NEAR(without->share, -0.05, 0.01);
}

}  // namespace
}  // namespace todbench::test
