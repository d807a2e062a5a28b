// SPDX-License-Identifier: GPL-3.0-or-later
// Packets lost, repeated, late, padded; ids that begin anew; control that is lost: no frame is taken for another.
#include <gmock/gmock.h>

#include <chrono>
#include <optional>
#include <ostream>
#include <tuple>
#include <utility>

#include "tests/acquisition/aravis/gvsp_passages.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

TEST(GvspFaults, LostPacketsAreSentAgainAndNoFrameIsLost) {
  auto config = quick();
  config.frame_rate_hz = 50;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started({.packet_size_bytes = 1400});
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.packet_loss = 0.01});

  const Received got = receive(*source, config, 150);

  EXPECT_EQ(got.complete, 150);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_EQ(got.gaps, 0);
  // 32 packets per frame: 150 frames lose 48 of them on average, and 20 is four standard deviations below.
  EXPECT_GT(camera->counts().faults.packets_lost, 20U);
  EXPECT_GT(camera->counts().packets_resent, 20U);
}

TEST(GvspFaults, FramesWithHolesAreMarkedWhereTheCameraDoesNotSendAgain) {
  for (const auto policy : {ResendPolicy::ignore, ResendPolicy::unavailable}) {
    auto config = quick();
    config.resend = policy;
    const auto camera = start_gvsp_camera(config);
    const auto source = open_started({.packet_size_bytes = 1400});
    ASSERT_TRUE(source && source->next(patience));
    camera->set_faults({.packet_loss = 0.01});

    const Received got = receive(*source, config, 100);

    // 1 - 0.99^32 = 28 % of the frames have a hole.
    EXPECT_GT(got.incomplete, 5);
    EXPECT_GT(got.complete, 30);
    EXPECT_EQ(got.false_pixels, 0);
  }
}

TEST(GvspFaults, RepeatedReorderedAndLatePacketsChangeNothing) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started({.packet_size_bytes = 1400});
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.duplicate = 0.05, .reorder = 0.05});

  const Received got = receive(*source, config, 100);

  EXPECT_EQ(got.complete, 100);
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(camera->counts().faults.packets_duplicated, 50U);
  EXPECT_GT(camera->counts().faults.packets_reordered, 50U);
}

TEST(GvspFaults, AFrameWhoseLeaderComesLateIsNeverTakenForAnother) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.late_leader = 0.2});

  const Received got = receive(*source, config, 100);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(got.complete, 50);
  EXPECT_GT(camera->counts().faults.late_leaders, 5U);
}

TEST(GvspFaults, LostAndWrongSizedFramesAreToldApart) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));
  camera->set_faults({.lost_frame = 0.1, .wrong_size = 0.1});

  const Received got = receive(*source, config, 100);

  const auto faults = camera->counts().faults;
  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_GT(got.wrong_size, 0);
  EXPECT_LE(got.wrong_size, static_cast<int>(faults.frames_wrong_size));
  EXPECT_GT(got.gaps, 0);
  EXPECT_LE(got.gaps, static_cast<int>(faults.frames_lost));
  EXPECT_EQ(got.incomplete, 0);
}

/// Bytes behind every row and behind the last one.
class StatedPadding : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(StatedPadding, IsTakenOutOfThePicture) {
  auto config = quick();
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.complete, 30);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST_P(StatedPadding, IsTakenOutOfAPictureWithChunksBehindIt) {
  auto config = quick();
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->set("ChunkModeActive", "On") && source->start());

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.complete, 30);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST_P(StatedPadding, ThatIsNotStatedMakesEveryFrameOneOfAWrongSize) {
  auto config = quick();
  config.states_padding = false;
  std::tie(config.row_padding_bytes, config.image_padding_bytes) = GetParam();
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 30);

  EXPECT_EQ(got.wrong_size, 30);
  EXPECT_EQ(got.complete, 0);
}

INSTANTIATE_TEST_SUITE_P(Gvsp, StatedPadding,
                         testing::Values(std::pair(8, 0), std::pair(1, 0), std::pair(320, 0), std::pair(0, 16),
                                         std::pair(6, 100)));

TEST(GvspFaults, FramesThatAreLargerThanStatedAreOfAWrongSize) {
  for (const int packet_bytes : {8000, 1436}) {
    auto config = quick();
    // With packets of 1436 bytes, 1400 of data, the payload of 160 x 140 pixels fills its 32 packets to the last byte.
    config.height = packet_bytes == 1436 ? 140 : 128;
    const auto camera = start_gvsp_camera(config);
    AravisOptions options;
    options.packet_size_bytes = packet_bytes;
    const auto source = open_started(options);
    ASSERT_TRUE(source && source->next(patience));
    camera->set_faults({.too_long = 0.5});

    const Received got = receive(*source, config, 100);

    const auto faults = camera->counts().faults;
    EXPECT_EQ(got.false_pixels, 0);
    // Binomial, n = 100, p = 0.5: outside 20 ... 80 with probability below 1e-8.
    EXPECT_GT(got.wrong_size, 20);
    EXPECT_GT(got.complete, 20);
    EXPECT_LE(got.wrong_size + got.incomplete, static_cast<int>(faults.frames_too_long));
    EXPECT_EQ(got.complete + got.wrong_size + got.incomplete, 100);
  }
}

/// The ids of the frames before and after they begin anew, and what the camera's clock does.
struct Renumbering {
  std::uint16_t first = 1;
  int frames = 0;
  std::uint16_t anew = 1;
  ClockRestart clock = ClockRestart::goes_on;
};
void PrintTo(const Renumbering& r, std::ostream* out) {
  *out << r.first << " + " << r.frames << " -> " << r.anew << (r.clock == ClockRestart::goes_on ? "" : " with clock");
}

class FrameIds : public testing::TestWithParam<Renumbering> {};

TEST_P(FrameIds, ThatBeginAnewHideNoLossAndInventNone) {
  const Renumbering& renumbering = GetParam();
  auto config = quick();
  config.first_block_id = renumbering.first;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_camera();
  // The stream that looks at the test ramp has used some ids.
  camera->restart_numbers(renumbering.first, ClockRestart::goes_on);
  ASSERT_TRUE(source && source->start());
  IntegrityGate gate({.width = config.width, .height = config.height});
  const auto began = camera->counts().exposures;
  for (int k = 0; k < renumbering.frames; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    static_cast<void>(gate.judge(*frame));
  }
  ASSERT_EQ(gate.lost(), 0U);
  camera->restart_numbers(renumbering.anew, renumbering.clock);

  // Aravis drops up to a hundred frames; what comes after them counts.
  std::uint64_t seen = static_cast<std::uint64_t>(renumbering.frames);
  std::int64_t last_exposure = 0;
  for (int k = 0; k < 50; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    static_cast<void>(gate.judge(*frame));
    ++seen;
    last_exposure = static_cast<std::int64_t>(camera->counts().exposures);
  }

  const auto exposed = static_cast<double>(last_exposure) - static_cast<double>(began);
  const auto accounted = static_cast<double>(seen + gate.lost());
  // Frames are on their way while the last one is read, and where only the host's clock knows, it knows by its jitter.
  EXPECT_NEAR(accounted, exposed, 6 + 0.1 * exposed);
  EXPECT_EQ(gate.numbering().restarts + gate.numbering().silent_gaps, 1U);
  EXPECT_THAT(describe(gate.numbering()), HasSubstr("estimated from the time"));
}

INSTANTIATE_TEST_SUITE_P(
    Gvsp, FrameIds,
    testing::Values(Renumbering{1, 40, 1, ClockRestart::goes_on}, Renumbering{1, 60, 1, ClockRestart::goes_on},
                    Renumbering{1, 60, 1, ClockRestart::begins_anew}, Renumbering{1, 130, 1, ClockRestart::goes_on},
                    Renumbering{1, 130, 1, ClockRestart::begins_anew}, Renumbering{59970, 30, 1, ClockRestart::goes_on},
                    Renumbering{59970, 30, 1, ClockRestart::begins_anew},
                    Renumbering{65500, 30, 1, ClockRestart::begins_anew},
                    Renumbering{30000, 30, 20000, ClockRestart::goes_on},
                    Renumbering{500, 60, 510, ClockRestart::goes_on}));

TEST(GvspFaults, ASilentControllerLosesControlAndTheStreamEnds) {
  auto config = quick();
  config.heartbeat_timeout = 600ms;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));

  camera->lose_control_messages(20s);

  Result<Frame> frame = source->next(300ms);
  while (frame || frame.error().code == ErrorCode::timeout) frame = source->next(300ms);
  EXPECT_EQ(frame.error().code, ErrorCode::disconnected);
  EXPECT_EQ(camera->counts().controls_lost, 1U);
  EXPECT_FALSE(camera->controlled());
}

TEST(GvspFaults, ACameraThatAnotherClientHasIsBusy) {
  const auto camera = start_gvsp_camera({});
  camera->deny_access();

  const auto source = aravis_backend()->open("gige:127.0.0.1");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr("busy"));
  camera->permit_access();
  EXPECT_TRUE(open_camera());
}

TEST(GvspFaults, AResetInMidStreamIsALostCameraThatCanBeOpenedAgain) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  auto source = open_started();
  ASSERT_TRUE(source && source->next(patience));

  camera->reset(200ms);

  Result<Frame> frame = source->next(300ms);
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while ((frame || frame.error().code == ErrorCode::timeout) && std::chrono::steady_clock::now() < deadline) {
    frame = source->next(300ms);
  }
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().code, ErrorCode::disconnected);
  source.reset();
  const auto again = open_started();
  ASSERT_TRUE(again);
  EXPECT_EQ(receive(*again, config, 10).false_pixels, 0);
}

}  // namespace
}  // namespace todbench
