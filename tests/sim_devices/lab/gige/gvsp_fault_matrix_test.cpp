// SPDX-License-Identifier: GPL-3.0-or-later
// Each fault of the way from a camera at 5 %, in a measurement over the wire.
#include "tests/sim_devices/lab/gige/gvsp_fault_matrix.h"

namespace todbench {
namespace {

using namespace test;

class WireFaultMatrix : public testing::TestWithParam<WireCell> {};

TEST_P(WireFaultMatrix, LeavesTheResultAsItIsWithoutTheFault) {
  const auto& [fault, rate] = GetParam();

  expect_the_result_without(fault, rate);
}

INSTANTIATE_TEST_SUITE_P(Wire, WireFaultMatrix,
                         testing::Combine(testing::ValuesIn(wire_faults()), testing::Values(0.05)),
                         [](const testing::TestParamInfo<WireCell>& cell) { return name_of(cell); });

TEST(EveryModel, DecidesAsTheSimulatedSensorForTheSameExposures) {
  for (const auto model : {CameraModel::ax5, CameraModel::a_series, CameraModel::legacy_science}) {
    const WireBench bench(model);
    const auto camera = bench.camera();
    const auto source = testing_support::open_camera();
    ASSERT_TRUE(camera && source) << to_string(model);

    const WireRun run = run_over_the_wire(bench, *source);

    ASSERT_TRUE(run.result) << to_string(model) << ": " << run.result.error().message;
    EXPECT_EQ(run.result->trials.size(), bench.trials_of_a_run());
    expect_only_true_frames_were_used(bench, run);
    const auto same = undisturbed(bench, run);
    ASSERT_TRUE(same) << same.error().message;
    expect_same_decisions(run.result->trials, same->trials);
  }
}

TEST(FaultCounts, OfFramesThatWereNotUsedAreThoseOfTheCamera) {
  const WireBench bench;
  const auto camera = bench.camera();
  const auto source = testing_support::open_camera();
  ASSERT_TRUE(camera && source);
  camera->set_faults({.swapped_bytes = 0.1, .wrong_size = 0.1});

  const WireRun run = run_over_the_wire(bench, *source);

  ASSERT_TRUE(run.result) << run.result.error().message;
  std::uint64_t wrong_size = 0, swapped = 0;
  for (const auto& frame : run.frames) {
    if (frame.status == FrameStatus::wrong_size) ++wrong_size;
    if (frame.status == FrameStatus::complete && !bench.log->knows(frame.counts)) ++swapped;
  }
  const auto& reasons = run.result->frames_rejected;
  const auto count = [&](const std::string& reason) { return reasons.count(reason) != 0 ? reasons.at(reason) : 0; };
  EXPECT_GT(wrong_size, 0U);
  EXPECT_GT(swapped, 0U);
  EXPECT_EQ(count("wrong_size"), wrong_size);
  EXPECT_EQ(count("byte_swapped") + count("swapped_bytes"), swapped);
  EXPECT_EQ(run.result->frames_lost, 0U);
}

}  // namespace
}  // namespace todbench
