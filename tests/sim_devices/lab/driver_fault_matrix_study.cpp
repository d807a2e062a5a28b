// SPDX-License-Identifier: GPL-3.0-or-later
// Each fault of the way from a camera on USB at three rates, in a long measurement.
#include "tests/sim_devices/lab/driver_fault_cameras.h"

namespace todbench {
namespace {

using namespace test;

constexpr int presentations = 100;

class DriverFaultMatrixStudy : public testing::TestWithParam<DriverCell> {};

TEST_P(DriverFaultMatrixStudy, LeavesTheAnswersAsTheyAreWithoutTheFault) {
  const DriverCell& cell = GetParam();

  expect_the_answers_without(cell.camera, cell.faults, cell.rate, presentations);
}

INSTANTIATE_TEST_SUITE_P(Each, DriverFaultMatrixStudy, testing::ValuesIn(every_fault({0.001, 0.01, 0.05})),
                         [](const auto& cell) { return name_of(cell); });

}  // namespace
}  // namespace todbench
