// SPDX-License-Identifier: GPL-3.0-or-later
// What happens when packets, frames or the whole camera are lost, over the real protocol on loopback.
#include <gmock/gmock.h>

#include <chrono>

#include "tests/support/gige_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

TEST(GigeLoss, LostExposuresLeaveAGapOfExactlyThatManyFrames) {
  const auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());
  auto last = source->next(patience);
  ASSERT_TRUE(last) << last.error().message;
  camera->lose_exposures(7);

  std::uint64_t gap = 0;
  for (int k = 0; k < 50 && gap == 0; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    gap = frame->sequence - last->sequence - 1;
    EXPECT_EQ(frame->sequence, exposure_index(*frame, 50));
    last = frame;
  }

  EXPECT_EQ(gap, 7U);
}

TEST(GigeLoss, FramesThatFoundTheBuffersFullAreUnread) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 100;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  // Two seconds of frames are kept.
  expect_unread_behind_a_slow_reader(
      *source, [&] { return camera->exposures(); }, 200, [&](unsigned count) { camera->lose_exposures(count); });
}

TEST(GigeLoss, FramesWithMissingPacketsAreMarkedAndCompleteOnesAreTrue) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 100;
  const auto camera = start_camera(config);
  AravisOptions options;
  options.packet_size_bytes = 1400;
  const auto source = open_camera(options);
  ASSERT_TRUE(source && source->start() && source->next(patience));
  camera->set_packet_loss(0.005, 7);

  // 115 packets per frame, so about 1 - 0.995^115 = 44 % of the frames have a hole.
  int complete = 0;
  int incomplete = 0;
  std::uint64_t last_sequence = 0;
  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_GT(frame->sequence, last_sequence);
    last_sequence = frame->sequence;
    if (frame->status != FrameStatus::complete) {
      ++incomplete;
      continue;
    }
    ++complete;
    const auto index = exposure_index(*frame, 100);
    ASSERT_EQ(frame->sequence, index);
    ASSERT_TRUE(same_pixels(frame->counts, test_picture(index, 320, 240, 14)));
  }

  // Binomial, n = 100, p = 0.44: outside 10 ... 80 with probability below 1e-11.
  EXPECT_GT(incomplete, 10);
  EXPECT_GT(complete, 20);
}

TEST(GigeDisconnection, IsReportedWhenTheProcessOfTheCameraIsKilledAndAFreshOneCanBeOpened) {
  auto camera = std::make_unique<CameraProcess>(50);
  ASSERT_TRUE(camera->started());
  auto source = open_camera();
  ASSERT_TRUE(source && source->start());
  for (int k = 0; k < 10; ++k) ASSERT_TRUE(source->next(patience));
  camera->kill();

  // Frames that were on their way, then silence: five timeouts of 0.5 s pass before the 3 s of silence do, and a sixth
  // with a slow answer; Aravis's own heartbeat notices after 5 s.
  Error error;
  int timeouts = 0;
  for (int k = 0; k < 200 && error.code != ErrorCode::disconnected; ++k) {
    const auto frame = source->next(500ms);
    if (frame) continue;
    error = frame.error();
    if (error.code == ErrorCode::timeout) ++timeouts;
  }

  EXPECT_EQ(error.code, ErrorCode::disconnected);
  EXPECT_LE(timeouts, 12);
  EXPECT_EQ(source->start().error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->get("Width").error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->next(1ms).error().code, ErrorCode::disconnected);
  source.reset();
  camera = std::make_unique<CameraProcess>(50);
  ASSERT_TRUE(camera->started());
  source = open_camera();
  ASSERT_TRUE(source && source->start());
  EXPECT_TRUE(source->next(patience));
}

TEST(GigeDisconnection, IsReportedToAReaderThatWaitsPatiently) {
  auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start() && source->next(patience));
  camera.reset();

  Error error;
  for (int k = 0; k < 200 && error.code != ErrorCode::disconnected; ++k) {
    const auto frame = source->next(patience);
    if (!frame) error = frame.error();
    ASSERT_NE(error.code, ErrorCode::timeout) << "the heartbeat has to end the wait";
  }

  EXPECT_EQ(error.code, ErrorCode::disconnected);
}

TEST(GigeDisconnection, ACameraThatIsOnlySlowIsNotTakenForLost) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 0.2;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  // The camera exposes at whole multiples of 5 s of the wall clock: up to two periods until the second frame.
  int frames = 0;
  for (int k = 0; k < 60 && frames < 2; ++k) {
    const auto frame = source->next(500ms);
    if (frame) ++frames;
    if (!frame) {
      ASSERT_EQ(frame.error().code, ErrorCode::timeout) << frame.error().message;
    }
  }

  EXPECT_EQ(frames, 2);
}

TEST(GigeSocket, TellsTheGrantedBufferAndWarnsWhenItIsLessThanAsked) {
  const auto camera = start_camera({});
  AravisOptions options;
  options.min_socket_buffer_bytes = 512U << 20U;
  const auto source = open_camera(options);
  ASSERT_TRUE(source);

  const auto granted = std::stoull(source->info().settings.at("SocketBufferBytes"));

  EXPECT_GT(granted, 0U);
  EXPECT_EQ(source->info().warnings.empty(), granted >= options.min_socket_buffer_bytes);
  for (const auto& warning : source->info().warnings) EXPECT_THAT(warning, HasSubstr("net.core.rmem_max"));
}

}  // namespace
}  // namespace todbench
