// SPDX-License-Identifier: GPL-3.0-or-later
// A measurement over the wire that loses its camera in mid-run, in each way once, or for good.
#include "tests/bench/run/lost_in_mid_run.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace test;

TEST(LostInMidRun, ComesBackAndEveryTrialIsMadeOnATrueFrame) {
  expect_a_whole_run_over(3);
}

TEST(LostInMidRun, ForGoodEndsTheRunWithWhatWasMeasured) {
  const WireBench bench;
  auto camera = bench.camera();
  const auto source = reconnecting(1s);
  ASSERT_TRUE(camera && source);
  bench.host->bring_back = [&](std::stop_token stop) { return source->recover(std::move(stop)); };
  MeasurementListener listener;
  listener.on_progress = [&](std::size_t presentations, std::size_t) {
    if (presentations == 2) camera.reset();
  };

  const WireRun run = run_over_the_wire(bench, *source, listener);

  ASSERT_TRUE(run.result) << run.result.error().message;
  ASSERT_TRUE(run.result->ended_by);
  EXPECT_EQ(run.result->ended_by->code, ErrorCode::disconnected);
  EXPECT_EQ(run.result->trials.size(), 2 * bench.plates.front().triangles.size());
}

}  // namespace
}  // namespace todbench
