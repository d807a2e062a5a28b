// SPDX-License-Identifier: GPL-3.0-or-later
// Each fault of the way from a camera at three rates, in a measurement over the wire.
#include "tests/sim_devices/lab/gige/gvsp_fault_matrix.h"

namespace todbench {
namespace {

using namespace test;

class WireFaultMatrixStudy : public testing::TestWithParam<WireCell> {};

TEST_P(WireFaultMatrixStudy, LeavesTheResultAsItIsWithoutTheFault) {
  const auto& [fault, rate] = GetParam();

  expect_the_result_without(fault, rate);
}

INSTANTIATE_TEST_SUITE_P(Wire, WireFaultMatrixStudy,
                         testing::Combine(testing::ValuesIn(wire_faults()), testing::Values(0.001, 0.01, 0.05)),
                         [](const testing::TestParamInfo<WireCell>& cell) { return name_of(cell); });

}  // namespace
}  // namespace todbench
