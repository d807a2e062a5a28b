// Coverage of the measures of a session over many seeds: the figures of docs/physical-measures.md.
#include <gtest/gtest.h>

#include "tests/bench/run/bars_coverage.h"
#include "tests/bench/run/edge_coverage.h"

namespace todbench {
namespace {

TEST(PlateEdgesStudy, HoldTheMtfOfTheSensorModel) {
  for (const double aberration_pitch : {0.0, 0.35, 0.7}) {
    const auto coverage = testing::edge_coverage(aberration_pitch, 200);
    ASSERT_TRUE(coverage) << coverage.error().message;
    for (std::size_t k = 0; k < coverage->within.size(); ++k) {
      fmt::print("aberration {} pitch, f {}: within {:.4f} of {} edges, mean error {:+.4f}\n", aberration_pitch,
                 testing::EdgeCoverage::frequencies[k], coverage->within[k], coverage->edges, coverage->mean_error[k]);
      // 2000 edges: standard error 0.005.
      EXPECT_GT(coverage->within[k], 0.95 - 4 * 0.005);
    }
    EXPECT_EQ(coverage->single_sided, 0);
  }
}

TEST(PlateBarsStudy, HoldTheCtfOfTheSensorModel) {
  for (const double aberration_pitch : {0.0, 0.35, 0.7}) {
    for (const double noise : {0.001, 0.004}) {
      SensorSpec sensor = *load_sensor("sc2000");
      sensor.aberration_sigma_pitch = aberration_pitch;
      const auto coverage = testing::bars_coverage(sensor, noise, 200, 20);
      ASSERT_TRUE(coverage) << coverage.error().message;
      fmt::print("aberration {} pitch, noise {}, far spread {:.4f}\n", aberration_pitch, noise, coverage->far_spread);
      for (const auto& group : coverage->groups) {
        fmt::print("  {:12} f {:.4f}", group.group, group.frequency_per_pitch);
        const double truths[] = {group.truth.best, group.truth.mean, group.truth.worst};
        for (std::size_t k = 0; k < 3; ++k) {
          fmt::print("  {:.4f} {:+.4f} +-{:.4f} {:.3f}", truths[k], group.mean_error[k], group.half_width[k],
                     group.within[k]);
          // 200 seeds: standard error 0.015. At four times the usual noise the extremes keep a bias.
          EXPECT_GT(group.within[k], noise > 0.002 ? 0.85 : 0.95 - 4 * 0.015) << group.group << ' ' << k;
        }
        fmt::print("\n");
      }
    }
  }
}

}  // namespace
}  // namespace todbench
