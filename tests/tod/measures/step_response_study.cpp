// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage of the time constant of steps over 200 seeds: the figures of docs/validation/physical-measures.md.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/tod/measures/step_coverage.h"

namespace todbench {
namespace {

TEST(StepResponseStudy, HoldsTheTimeConstant) {
  const testing::StepCase cases[] = {{},
                                     {.exposure_s = 0.02},
                                     {.time_constant_s = 0.007, .exposure_s = 0.004},
                                     {.time_constant_s = 0.012, .exposure_s = 0.004, .correlation = 0.5},
                                     {.time_constant_s = 0.012, .noise_k = 0.02, .correlation = 0.8},
                                     {.time_constant_s = 0.05, .noise_k = 0.02},
                                     {.time_constant_s = 0.012, .target_s = 0.0005, .settling_s = 0.005}};
  for (const testing::StepCase& one : cases) {
    const auto found = testing::step_coverage(one, 200);
    fmt::print(
        "time constant {} s, exposure {} s, noise {} K, correlation {}, settling {} s: told {}, within {:.3f}, error "
        "{:+.4f}, half width {:.4f}; rises {} within {:.3f}, falls {} within {:.3f}\n",
        one.time_constant_s, one.exposure_s, one.noise_k, one.correlation, one.settling_s, found.told, found.within,
        found.mean_error, found.half_width, found.rises, found.rise_within, found.falls, found.fall_within);
    // 200 seeds: standard error 0.015.
    EXPECT_GT(found.within, 0.95 - 3 * 0.015);
  }
}

}  // namespace
}  // namespace todbench
