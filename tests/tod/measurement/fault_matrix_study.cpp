// SPDX-License-Identifier: GPL-3.0-or-later
// Each reason of the integrity gate alone, at three rates: 27 measurements and as many undisturbed ones.
#include "tests/tod/measurement/fault_matrix.h"

namespace todbench {
namespace {

using test::FaultMatrix;

class FaultMatrixStudy : public FaultMatrix, public testing::WithParamInterface<std::tuple<Rejection, double>> {};

std::string cell_name(const testing::TestParamInfo<std::tuple<Rejection, double>>& info) {
  return std::string(to_string(std::get<0>(info.param))) + "_at_" +
         std::to_string(static_cast<int>(std::get<1>(info.param) * 1000)) + "_in_a_thousand";
}
INSTANTIATE_TEST_SUITE_P(Cell, FaultMatrixStudy,
                         testing::Combine(testing::ValuesIn(all_rejections), testing::Values(0.001, 0.01, 0.05)),
                         cell_name);

TEST_P(FaultMatrixStudy, LeavesTheAnswersAsTheyWere) {
  const auto& [reason, share] = GetParam();

  expect_same_answers({.faults = {reason}, .share = share, .first = 5, .seed = 4});
}

}  // namespace
}  // namespace todbench
