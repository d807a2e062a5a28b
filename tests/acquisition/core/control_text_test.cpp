// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/control_text.h"

#include <gtest/gtest.h>

#include "acquisition/base/host_clock.h"

namespace todbench {
namespace {

TEST(ControlText, BringsEveryNumberBackBitForBit) {
  for (const double value : {0.01, 1.0 / 64, -273.15, 1e-300, 0.0}) {
    EXPECT_EQ(control_number(control_text(value)), value);
  }
}

TEST(ControlText, IsANumberOnlyAsAWhole) {
  for (const char* text : {"", " 1", "1 ", "1,5", "1K", "nan", "inf", "0x10", "+1"}) {
    EXPECT_EQ(control_number(text), std::nullopt) << text;
  }
  EXPECT_EQ(control_number("-2.5e1"), -25.0);
}

TEST(HostClock, NeverGoesBack) {
  const std::int64_t before = monotonic_ns();

  EXPECT_GE(monotonic_ns(), before);
}

}  // namespace
}  // namespace todbench
