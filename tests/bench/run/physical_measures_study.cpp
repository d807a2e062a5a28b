// Coverage of the measures of a session over many seeds: the figures of docs/physical-measures.md.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace todbench
