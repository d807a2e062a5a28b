// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement through an emulated V4L2 camera makes the decisions of the simulated camera for the same exposures.
#include <gmock/gmock.h>

#include <algorithm>

#include "acquisition/v4l2/v4l2_backend.h"
#include "sim_devices/lab/v4l2_laboratory.h"
#include "sim_devices/lab/video/v4l2_camera.h"
#include "tests/sim_devices/lab/measured_twice.h"
#include "tests/support/parameter_names.h"

namespace todbench {
namespace {

class V4l2Measurement : public testing::TestWithParam<VideoCameraKind> {};

/// A measurement through the node, and the same without the exposures that arrived short.
void measure_both(VideoCameraConfig config, test::MeasuredTwice& both) {
  test::SimulatedBench bench = test::bench_for_both();
  bench.spec = with_counts_of(config.kind, bench.spec);
  MeasurementOptions options = test::options_for_both(bench);
  options.max_rejected_share = 0.2;
  measure_twice(bench, options,
                {.connect = connect_v4l2(MockSystem::create(), config),
                 .backend = v4l2_backend(),
                 .exposure_of = test::exposure_by_clock(bench.spec.frame_rate_hz),
                 .is_short = [config](std::uint64_t exposure) { return arrives_short(config, exposure); }},
                both);
}

TEST_P(V4l2Measurement, DecidesAsTheSimulatedCameraForTheSameExposures) {
  test::MeasuredTwice both;
  ASSERT_NO_FATAL_FAILURE(measure_both({.kind = GetParam()}, both));

  ASSERT_GE(both.measured.trials.size(), 2U * 2 * 3 * 20);  // plates, contrasts, phases, triangles
  test::expect_same_decisions(both.measured.trials, both.simulated.trials);
}

TEST_P(V4l2Measurement, FramesOfAnotherSizeAreCountedAndNeverMeasured) {
  // Registration and contrast take 16 frames in succession: there is a short one among them.
  const VideoCameraConfig config{.kind = GetParam(), .short_frame_interval = 10};
  test::MeasuredTwice both;
  ASSERT_NO_FATAL_FAILURE(measure_both(config, both));

  const auto arrived_short = static_cast<std::uint64_t>(
      std::count_if(both.exposures.begin(), both.exposures.end(),
                    [&](std::uint64_t exposure) { return arrives_short(config, exposure); }));
  EXPECT_GT(arrived_short, 0U);
  EXPECT_EQ(both.measured.frames_rejected, (std::map<std::string, std::uint64_t>{{"wrong_size", arrived_short}}));
  EXPECT_EQ(both.measured.frames_lost, 0U);
  ASSERT_GE(both.measured.trials.size(), 2U * 2 * 3 * 20);
  test::expect_same_decisions(both.measured.trials, both.simulated.trials);
}

std::string name_of(const testing::TestParamInfo<VideoCameraKind>& kind) {
  return test::name_of(kind.param);
}

INSTANTIATE_TEST_SUITE_P(Every, V4l2Measurement,
                         testing::Values(VideoCameraKind::lepton, VideoCameraKind::temperature_rows), name_of);

}  // namespace
}  // namespace todbench
