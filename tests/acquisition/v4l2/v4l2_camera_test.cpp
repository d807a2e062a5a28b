// SPDX-License-Identifier: GPL-3.0-or-later
// The V4L2 back end against an emulated camera: real open, ioctl, mmap and udev calls of this process.
#include <gmock/gmock.h>

#include <ostream>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

#include "acquisition/base/host_clock.h"
#include "tests/support/parameter_names.h"
#include "tests/support/video_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;

VideoCameraConfig small(VideoCameraKind kind) {
  VideoCameraConfig config;
  config.kind = kind;
  config.width = 160;
  config.height = 120;
  config.frame_rate_hz = 200;
  return config;
}

class V4l2Pixels : public testing::TestWithParam<VideoCameraKind> {};

TEST_P(V4l2Pixels, AHundredFramesEqualTheirExposures) {
  const auto config = small(GetParam());
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());

  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_TRUE(
        same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 160, 120, picture_bits(config.kind))));
  }
}

std::string name_of(const testing::TestParamInfo<VideoCameraKind>& kind) {
  return test::name_of(kind.param);
}

INSTANTIATE_TEST_SUITE_P(Every, V4l2Pixels,
                         testing::Values(VideoCameraKind::y16, VideoCameraKind::y14, VideoCameraKind::grey,
                                         VideoCameraKind::lepton, VideoCameraKind::boson,
                                         VideoCameraKind::temperature_rows),
                         name_of);

TEST(V4l2Cameras, AreListedByVendorModelAndSerial) {
  VideoCameraConfig config = small(VideoCameraKind::lepton);
  config.vendor = "GroupGets";
  config.model = "PureThermal (fw:v1.3.0)";
  config.serial = "8008001c";
  const auto bench = start_video(config);

  const auto camera = only_camera(*v4l2_backend());

  EXPECT_EQ(camera.id, "v4l2:GroupGets-PureThermal__fw_v1.3.0_-8008001c");
  EXPECT_EQ(camera.serial, "8008001c");
  EXPECT_EQ(camera.address, bench.camera->node());
}

TEST(V4l2Cameras, TwoOfAKindAreToldApartByTheirSerials) {
  auto first = small(VideoCameraKind::y16);
  auto second = first;
  first.serial = "A1";
  second.serial = "B2";
  second.width = 80;
  const auto bench = start_video(first);
  const auto other =
      EmulatedV4l2Camera::start(bench.system, second, [](std::uint64_t) { return cv::Mat1w::zeros(120, 80); });
  ASSERT_TRUE(other) << other.error().message;

  const auto opened = open_video(second);

  ASSERT_TRUE(opened);
  EXPECT_EQ(opened->info().width, 80);
  EXPECT_EQ(opened->info().serial, "B2");
}

TEST(V4l2Cameras, AnAbsentCameraIsNotFoundAndThoseSeenAreNamed) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);

  const auto source = v4l2_backend()->open("v4l2:Nobody-Nothing-7");

  expect_not_found(source, video_camera_id(config));
}

TEST(V4l2Cameras, AFormatThatTheCameraDoesNotHaveIsRefusedWithThoseItHas) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);

  const auto source = v4l2_backend({.pixel_format = "Mono14"})->open(video_camera_id(config));

  expect_not_found(source, "Y16  160x120");
}

TEST(V4l2Cameras, ASecondProgramIsToldThatTheCameraIsBusy) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto first = open_video(config);
  ASSERT_TRUE(first && first->start());

  const auto second = v4l2_backend()->open(video_camera_id(config));

  expect_not_found(second, "busy");
}

TEST(V4l2Scale, OfALeptonIsWhatItsTelemetrySays) {
  const auto config = small(VideoCameraKind::lepton);
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 0.01}).value());
  EXPECT_EQ(source->info().height, 120);
}

TEST(V4l2Scale, OfALeptonIsLearntBehindFirstFramesThatAreEmpty) {
  auto config = small(VideoCameraKind::lepton);
  config.empty_first_frames = 3;
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 0.01}).value());
}

TEST(V4l2Boson, IsReadWithoutItsTelemetrySoThatFrozenFramesAreEqual) {
  auto config = small(VideoCameraKind::boson);
  config.width = 320;
  config.height = 256;
  const auto bench = start_video(config);
  for (const char* size : {"", "320x258"}) {
    const auto source = open_video(config);
    ASSERT_TRUE(source);
    EXPECT_EQ(*source->get("FrameSize"), "320x256");
    const bool chosen = *size == 0 || source->set("FrameSize", size).has_value();
    ASSERT_TRUE(chosen);
    ASSERT_TRUE(source->start());

    EXPECT_EQ(source->info().height, 256);
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    EXPECT_TRUE(same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 320, 256, 16)));
    EXPECT_FALSE(source->set("FrameSize", "640x512"));
  }
}

TEST(V4l2Serial, ThatManyCamerasShareIsSaid) {
  auto config = small(VideoCameraKind::y16);
  config.serial = "200901010001";
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().warnings, testing::Contains(testing::HasSubstr("placeholder")));
  EXPECT_THAT(only_camera(*v4l2_backend()).note, testing::HasSubstr("placeholder"));
}

TEST(V4l2Scale, OfTemperatureRowsIsSixtyFourthsOfAKelvin) {
  const auto config = small(VideoCameraKind::temperature_rows);
  const auto bench = start_video(config);

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 1.0 / 64}).value());
  EXPECT_EQ(source->info().pixel_format, "Mono16");
  EXPECT_THAT(source->info().warnings, testing::Contains(testing::HasSubstr("high-gain mode")));
  ASSERT_TRUE(source->set("TemperatureLinearScale", "0.0625"));
  EXPECT_THAT(source->info().warnings, testing::Not(testing::Contains(testing::HasSubstr("high-gain mode"))));
}

TEST(V4l2Scale, OfAPlainCameraIsWhatTheUserStates) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);

  expect_to_take_a_stated_scale(*source);
}

TEST(V4l2Stream, AFrameRateThatIsSetIsReadBack) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("AcquisitionFrameRate", "25"));

  EXPECT_EQ(source->info().frame_rate_hz, 25);
}

TEST(V4l2Stream, LostExposuresAreAGapOfTheirNumber) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());

  expect_gap_of_lost_exposures(*source, [&](unsigned count) { bench.camera->lose_exposures(count); });
}

TEST(V4l2Stream, FramesThatFoundTheBuffersFullAreUnread) {
  auto config = small(VideoCameraKind::y16);
  config.frame_rate_hz = 100;
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());

  expect_unread_behind_a_slow_reader(
      *source, [&] { return bench.camera->exposures(); }, 256,
      [&](unsigned count) { bench.camera->lose_exposures(count); });
}

TEST(V4l2Stream, AFrameWithMissingBytesIsIncompleteAndTheNextIsGood) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->truncate_next_frame(100);

  EXPECT_EQ(next_damaged(*source).value().status, FrameStatus::incomplete);
  EXPECT_EQ(source->next(patience).value().status, FrameStatus::complete);
}

/// What a driver does otherwise than uvcvideo.
struct Quirk {
  const char* name;
  VideoDriverQuirks quirks;
};
void PrintTo(const Quirk& quirk, std::ostream* out) {
  *out << quirk.name;
}

class V4l2Quirks : public testing::TestWithParam<std::tuple<Quirk, VideoCameraKind>> {};

TEST_P(V4l2Quirks, ChangeNoPixel) {
  const auto& [quirk, kind] = GetParam();
  const auto config = small(kind);
  const auto bench = start_video(config, quirk.quirks);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_EQ(source->info().width, 160);
  EXPECT_EQ(source->info().height, 120);

  for (int k = 0; k < 20; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_TRUE(same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 160, 120, picture_bits(kind))));
  }
}

using Sizes = VideoDriverQuirks::Sizes;
INSTANTIATE_TEST_SUITE_P(
    Every, V4l2Quirks,
    testing::Combine(
        testing::Values(Quirk{"stepwise", {.sizes = Sizes::stepwise}},
                        Quirk{"continuous", {.sizes = Sizes::continuous}},
                        Quirk{"unlisted", {.sizes = Sizes::unlisted}},
                        Quirk{"unlisted_no_parameters", {.sizes = Sizes::unlisted, .has_parameters = false}},
                        Quirk{"padded", {.row_padding_bytes = 8}}, Quirk{"padded_much", {.row_padding_bytes = 320}}),
        testing::Values(VideoCameraKind::y16, VideoCameraKind::grey, VideoCameraKind::temperature_rows)),
    [](const auto& parameters) {
      return std::string(std::get<0>(parameters.param).name) + "_" + test::name_of(std::get<1>(parameters.param));
    });

TEST(V4l2Stream, ACameraThatOnlySaysItsPresentFormatIsOpenedWithIt) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config, {.sizes = Sizes::unlisted, .has_try_format = false, .has_parameters = false});

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().width, 160);
  EXPECT_EQ(source->info().height, 120);
  EXPECT_EQ(source->info().frame_rate_hz, 0);
}

TEST(V4l2Stream, ALeptonWhoseSizesAreNotListedIsReadWithItsTelemetry) {
  const auto config = small(VideoCameraKind::lepton);
  const auto bench = start_video(config, {.sizes = Sizes::unlisted});

  const auto source = open_video(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().height, 120);
  EXPECT_EQ(source->info().settings.at("TelemetryRows"), "2");
}

TEST(V4l2Stream, PaddingThatIsNotStatedMakesEveryFrameOneOfAWrongSize) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config, {.row_padding_bytes = 8, .states_row_bytes = false});
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());

  for (int k = 0; k < 20; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::wrong_size);
  }
}

/// Bytes that a driver states, and what becomes of the frame.
class FalseLengths : public testing::TestWithParam<std::pair<std::uint32_t, FrameStatus>> {};

TEST_P(FalseLengths, AreNeverCompleteFrames) {
  const auto [bytes, status] = GetParam();
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start() && source->next(patience));
  bench.camera->misstate_next_frame(bytes);

  int odd = 0;
  for (int k = 0; k < 20; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    if (frame->status == FrameStatus::complete) continue;
    ++odd;
    EXPECT_EQ(frame->status, status);
  }

  EXPECT_EQ(odd, 1);
}

INSTANTIATE_TEST_SUITE_P(V4l2, FalseLengths,
                         testing::Values(std::pair(0xFFFFFFFFU, FrameStatus::wrong_size),
                                         std::pair(0x80000000U, FrameStatus::wrong_size),
                                         std::pair(40961U, FrameStatus::wrong_size),  // larger than the buffer
                                         std::pair(40960U, FrameStatus::wrong_size),  // all of it
                                         std::pair(38401U, FrameStatus::wrong_size),  // larger than the picture
                                         std::pair(38399U, FrameStatus::wrong_size),
                                         std::pair(1U, FrameStatus::wrong_size),
                                         std::pair(0U, FrameStatus::incomplete)));

TEST(V4l2Stream, ABufferThatDoesNotExistEndsTheStream) {
  for (const std::uint32_t index : {9U, 32U, 0xFFFFFFFFU}) {
    const auto config = small(VideoCameraKind::y16);
    const auto bench = start_video(config);
    const auto source = open_video(config);
    ASSERT_TRUE(source && source->start() && source->next(patience));
    bench.camera->misplace_next_frame(index);

    Result<Frame> frame = source->next(patience);
    for (int k = 0; k < 300 && frame; ++k) frame = source->next(patience);

    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::disconnected);
  }
}

TEST(V4l2Stream, ASequenceThatBeginsAnewHidesNoLossAndInventsNone) {
  for (const std::uint32_t anew : {0U, 1U, 5U, 0xFFFFFFF0U}) {
    const auto config = small(VideoCameraKind::y16);
    const auto bench = start_video(config);
    const auto source = open_video(config);
    ASSERT_TRUE(source && source->start());
    auto last = source->next(patience);
    for (int k = 0; k < 40; ++k) last = source->next(patience);
    ASSERT_TRUE(last);
    bench.camera->restart_sequence(anew);

    int restarts = 0;
    for (int k = 0; k < 40; ++k) {
      const auto frame = source->next(patience);
      ASSERT_TRUE(frame) << frame.error().message;
      restarts += frame->numbering == Numbering::restarted ? 1 : 0;
      ASSERT_EQ(frame->sequence - last->sequence, exposure_of(*frame, 200) - exposure_of(*last, 200)) << anew;
      last = frame;
    }

    EXPECT_EQ(restarts, 1) << anew;
  }
}

TEST(V4l2Cameras, OfOneKindAndSerialAreToldApartByTheirPorts) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto other =
      EmulatedV4l2Camera::start(bench.system, config, [](std::uint64_t) { return cv::Mat1w::zeros(120, 160); });
  ASSERT_TRUE(other) << other.error().message;

  const auto listed = v4l2_backend()->list();
  const auto opened = v4l2_backend()->open(video_camera_id(config));

  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 2U);
  for (const auto& camera : *listed) {
    EXPECT_THAT(camera.id, testing::StartsWith(video_camera_id(config) + "-at_1_"));
    EXPECT_TRUE(v4l2_backend()->open(camera.id).has_value());
  }
  EXPECT_NE((*listed)[0].id, (*listed)[1].id);
  // Neither is taken for the other.
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::not_found);
}

TEST(V4l2Stream, ACameraThatIsUnpluggedIsDisconnectedAndStaysDead) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->unplug();

  const auto next = end_of(*source);
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->next(0ms).error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->start().error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->get("Width").error().code, ErrorCode::disconnected);
}

TEST(V4l2Stream, ACameraThatIsPluggedInAgainIsFoundBySerialAtAnotherNode) {
  const auto config = small(VideoCameraKind::y16);
  auto bench = start_video(config);
  const std::string first_node = bench.camera->node();
  bench.camera.reset();

  auto camera =
      EmulatedV4l2Camera::start(bench.system, config, [](std::uint64_t k) { return test_picture(k, 160, 120, 16); });

  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_NE((*camera)->node(), first_node);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_TRUE(source->next(patience));
}

TEST(V4l2Stream, StopWakesAReaderThatWaitsForASlowCamera) {
  auto config = small(VideoCameraKind::y16);
  config.frame_rate_hz = 0.1;
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  const auto nothing = source->next(1ms);

  const auto woken = woken_by_stop(*source);

  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().code, ErrorCode::timeout);
  EXPECT_EQ(woken.error().code, ErrorCode::interrupted);
}

TEST(V4l2Stream, TheHostTimeOfAFrameIsItsArrivalHoweverLateItIsRead) {
  const auto config = small(VideoCameraKind::y16);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  // Exposure 20 has begun: the ones before it have been delivered to the driver and, with 8 buffers there, to the
  // receiving thread at least up to the eleventh.
  while (bench.camera->exposures() < 20) std::this_thread::yield();
  const auto scene_changes_ns = monotonic_ns();

  const auto first = source->next(patience);

  ASSERT_TRUE(first);
  EXPECT_LT(first->host_time_ns, scene_changes_ns);
}

TEST(V4l2Stream, FramesDuringACorrectionSaySoAndTellTheTimeAfterIt) {
  auto config = small(VideoCameraKind::lepton);
  config.nuc_freeze_frames = 5;
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_EQ(source->next(patience)->since_correction_s, -1);
  const auto before_ns = monotonic_ns();

  ASSERT_TRUE(source->correct_nonuniformity());

  int running = 0;
  double since_s = -1;
  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    if (frame->correction == CorrectionState::running) ++running;
    if (frame->correction == CorrectionState::idle && running > 0) since_s = frame->since_correction_s;
  }
  EXPECT_EQ(running, 5);
  EXPECT_GT(since_s, 0);
  EXPECT_LE(since_s, 1e-9 * static_cast<double>(monotonic_ns() - before_ns));
}

TEST(V4l2Stream, ACorrectionIsCommandedByItsButton) {
  const auto config = small(VideoCameraKind::lepton);
  const auto bench = start_video(config);
  const auto source = open_video(config);
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->correct_nonuniformity());

  EXPECT_EQ(bench.camera->nonuniformity_corrections(), 1U);
}

}  // namespace
}  // namespace todbench
