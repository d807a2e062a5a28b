// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of IFOV and distortion over 200 seeds: the figures of docs/validation/physical-measures.md.
#include <fmt/format.h>

#include "tests/tod/measures/geometry_coverage.h"

namespace todbench {
namespace {

TEST(PlateGeometryStudy, HoldsScaleRotationAndDistortion) {
  const testing::LensCase cases[] = {{},
                                     {.distortion = -0.02},
                                     {.distortion = 0.05},
                                     {.distortion = -0.02, .noise_k = 0.1},
                                     {.distortion = -0.02, .noise_k = 0.005},
                                     {.distortion = -0.01, .mm_per_px = 1.35, .most_tilt_per_mm = 5e-5}};
  for (const char* name : {"tcat-a", "tcat-b"}) {
    const TargetPlate plate = testing::shipped_plate(name);
    for (const testing::LensCase& lens : cases) {
      const auto found = testing::geometry_coverage(plate, lens, 200);
      fmt::print("{} {} mm/px, distortion {} %, noise {} K: refused {}, residual {:.4f} px;", name, lens.mm_per_px,
                 100 * lens.distortion, lens.noise_k, found.refused, found.residual_px);
      for (std::size_t k = 0; k < found.within.size(); ++k) {
        fmt::print("  {:.3f} ({:+.5f} +-{:.5f})", found.within[k], found.mean_error[k], found.half_width[k]);
        // 200 seeds: standard error 0.015.
        EXPECT_GT(found.within[k], 0.95 - 4 * 0.015) << name << ' ' << k;
      }
      fmt::print("\n");
      EXPECT_EQ(found.refused, 0);
    }
  }
}

}  // namespace
}  // namespace todbench
