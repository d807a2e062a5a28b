// SPDX-License-Identifier: GPL-3.0-or-later
// Size-of-source effect: the curve holds the closed form of a known halo, without a halo it is flat, and a session
// judges it.
#include "tod/camera_measures/source_size.h"

#include <gmock/gmock.h>

#include <cstdio>

#include "tests/bench/run/source_size_coverage.h"

namespace todbench {
namespace {

using testing::source_size_coverage;
using testing::SourceHalo;

TEST(SourceSize, HoldsTheClosedFormOfAHalo) {
  for (const SourceHalo halo : {SourceHalo{0, 1}, SourceHalo{0.05, 10}, SourceHalo{0.1, 30}}) {
    const auto found = source_size_coverage(halo, 1, 0.0015, 4);
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t k = 0; k < found->sides_px.size(); ++k) {
      std::printf("halo %g %% of %g px, side %g px: truth %.4f, error %+.4f, half-width %.4f, held %.2f\n",
                  100 * halo.share, halo.sigma_px, found->sides_px[k], found->truth[k], found->mean_error[k],
                  found->half_width[k], found->within[k]);
      // Four intervals of 95 %: two or more outside in 1.4 % of such tests.
      EXPECT_GE(found->within[k], 0.75);
      EXPECT_LT(found->half_width[k], 0.01);
      EXPECT_GE(found->point_within[k], 0.75);
    }
    std::printf("points held %.2f %.2f %.2f, consistent %.2f, reference %+.4f\n", found->point_within[0],
                found->point_within[1], found->point_within[2], found->consistent, found->slope_error);
    EXPECT_NEAR(found->slope_error, 0, 0.002);
  }
}

}  // namespace
}  // namespace todbench
