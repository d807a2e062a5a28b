// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of every part of the computation, found again within 1e-12 by another compiler.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/selftest/selftest_cases.h"

namespace todbench {
namespace {

TEST(Compilers, FindTheSameNumbers) {
  const auto found = numbers_of_every_part();

  ASSERT_EQ(golden_numbers().size(), found.size());
  for (const auto& [name, value] : found) {
    ASSERT_TRUE(golden_numbers().contains(name)) << name;
    const double expected = golden_numbers().at(name);
    EXPECT_NEAR(value, expected, 1e-12 * std::max(1.0, std::abs(expected))) << name;
  }
}

}  // namespace
}  // namespace todbench
