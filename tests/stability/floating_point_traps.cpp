// SPDX-License-Identifier: GPL-3.0-or-later
// Every test of this family runs with trapped floating-point exceptions: a NaN that is made, a division by zero or an
// overflow ends the program at the instruction that does it.
#include <fenv.h>
#include <gtest/gtest.h>

namespace todbench {
namespace {

class Traps final : public ::testing::EmptyTestEventListener {
  void OnTestStart(const ::testing::TestInfo& /*info*/) override {
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  }
  void OnTestEnd(const ::testing::TestInfo& /*info*/) override { fedisableexcept(FE_ALL_EXCEPT); }
};

/// The traps themselves are tested: a program without them would pass for the wrong reason.
TEST(FloatingPointTrapsDeathTest, EndTheProgramWhereANumberIsLost) {
  volatile double zero = 0;

  EXPECT_DEATH(
      {
        volatile double lost = zero / zero;
        (void)lost;
      },
      "");
}

}  // namespace
}  // namespace todbench

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ::testing::UnitTest::GetInstance()->listeners().Append(new todbench::Traps);
  return RUN_ALL_TESTS();
}
