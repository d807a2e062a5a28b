// SPDX-License-Identifier: GPL-3.0-or-later
// Corrections of the non-uniformity in a measurement: commanded, left to the camera, refused.
#include <gmock/gmock.h>

#include "tests/tod/measurement/faulty_bench.h"

namespace todbench {
namespace {

using test::DisturbedSource;
using test::SmallBench;

TEST(MeasurementNuc, CorrectsBeforeTheRunAndKeepsFramesOutUntilItHasPassed) {
  const SmallBench bench;
  std::int64_t now_ns = 0;  // a frame every 20 ms, however long it takes to form it
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 3600;
  options.nuc_wait_s = 0.51;
  bench.host->clock = [&](Moment) { return now_ns; };
  DisturbedSource source(bench.camera(), [&](std::uint64_t, Frame frame) -> Result<Frame> {
    frame.host_time_ns = now_ns += 20'000'000;
    return frame;
  });

  const auto result = bench.run(source, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_EQ(source.corrections, 1);
  ASSERT_TRUE(result->frames_rejected.contains("nonuniformity_correction"));
  EXPECT_EQ(result->frames_rejected.at("nonuniformity_correction"), 25u);  // 20 ... 500 ms after the command
  for (const auto& trial : result->trials) EXPECT_GE(trial.since_nuc_s, 0.51);
}

TEST(MeasurementNuc, IsLeftToACameraThatTakesNoCommandAndTellsOfItsCorrections) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 60;
  options.nuc_wait_s = 0;  // the frames of the correction itself are what counts here
  DisturbedSource source(bench.camera(), [](std::uint64_t index, Frame frame) -> Result<Frame> {
    frame.correction = index % 40 < 3 ? CorrectionState::running : CorrectionState::idle;
    return frame;
  });
  source.takes_commands = false;

  const auto result = bench.run(source, options);

  ASSERT_TRUE(result.has_value()) << result.error().message;
  EXPECT_FALSE(result->ended_by.has_value());
  EXPECT_EQ(source.corrections, 1);
  EXPECT_THAT(result->notes, testing::Contains(testing::HasSubstr("there is no such command")));
  EXPECT_GT(result->frames_rejected.at("nonuniformity_correction"), 3u);
}

TEST(MeasurementNuc, IsRefusedWhereTheCameraTakesNoCommandAndTellsNothing) {
  const SmallBench bench;
  MeasurementOptions options = test::options_of(bench);
  options.nuc_interval_s = 60;
  DisturbedSource source(bench.camera(), [](std::uint64_t, Frame frame) -> Result<Frame> {
    frame.correction = CorrectionState::unknown;
    return frame;
  });
  source.takes_commands = false;

  const auto result = bench.run(source, options);

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace todbench
