// SPDX-License-Identifier: GPL-3.0-or-later
// How often the contrast of the large triangles of a frame in grey levels holds the truth.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/tod/measurement/grey_frames.h"

namespace todbench {
namespace {

TEST(GreyLevelsStudy, TheContrastOfAFrameHoldsTheTruthInNinetyFivePercent) {
  constexpr int seeds = 1000;
  for (const test::GreyCase one :
       {test::GreyCase{16.9, 11}, test::GreyCase{16.9, 4}, test::GreyCase{16.9, 1.5}, test::GreyCase{1.93, 80},
        test::GreyCase{1.93, 20}, test::GreyCase{0.5, 100}, test::GreyCase{0.23, 100}}) {
    const test::GreyCoverage found = test::grey_coverage(one, seeds);
    std::cout << one.delta_t_k << " K, " << one.levels_per_k << " levels/K: held in " << 100 * found.share() << " % of "
              << found.frames << ", estimate/truth " << found.mean_ratio << ", half-width " << found.mean_half_width
              << " levels\n";
    EXPECT_EQ(found.frames, seeds);
    EXPECT_GE(found.share(), 0.93) << "three standard errors of 0.7 % below";
  }
}

}  // namespace
}  // namespace todbench
