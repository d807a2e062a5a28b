// SPDX-License-Identifier: GPL-3.0-or-later
// The USB back end against an emulated Seek camera: real libusb calls of this process, on an emulated bus.
#include <gmock/gmock.h>

#include "acquisition/core/integrity_gate.h"
#include "acquisition/usb/usb_backend.h"
#include "tests/support/parameter_names.h"
#include "tests/support/usb_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;

SeekCameraConfig fast(SeekModel model) {
  SeekCameraConfig config;
  config.model = model;
  config.frame_rate_hz = 500;
  return config;
}

class SeekPixels : public testing::TestWithParam<SeekModel> {};

TEST_P(SeekPixels, AHundredAndFiftyFramesEqualTheirExposuresAcrossTheWrapOfTheCounter) {
  const auto config = fast(GetParam());
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());

  for (std::uint64_t k = 0; k < 150; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_EQ(frame->sequence, k);
    ASSERT_EQ(frame->correction, CorrectionState::idle);
    ASSERT_TRUE(same_pixels(frame->counts, seek_picture(GetParam(), k + seek_calibration_frames)));
  }
}

INSTANTIATE_TEST_SUITE_P(Every, SeekPixels, testing::Values(SeekModel::compact, SeekModel::compact_pro),
                         [](const auto& model) { return std::string(to_string(model.param)); });

TEST(SeekCameras, AreListedByModelAndSerial) {
  auto config = fast(SeekModel::compact_pro);
  config.serial = "0A 1B";
  const auto bench = plug_seek(config);

  const auto camera = only_camera(*usb_backend());

  EXPECT_EQ(camera.id, "usb:SEEK-CompactPRO-0A_1B");
  EXPECT_EQ(camera.address, bench.port->node());
}

TEST(SeekCameras, WithoutASerialNumberAreKnownByTheirChip) {
  auto config = fast(SeekModel::compact);
  config.serial = "";
  const auto bench = plug_seek(config);

  EXPECT_EQ(only_camera(*usb_backend()).id, "usb:SEEK-Compact-544230303031000102030405");
}

TEST(SeekCameras, TwoOfAKindAreToldApartByTheirSerials) {
  auto first = fast(SeekModel::compact_pro);
  auto second = first;
  second.serial = "TB0002";
  const auto bench = plug_seek(first);
  const auto other = SeekCamera::create(second, [](std::uint64_t) { return cv::Mat1w(240, 320, std::uint16_t{5}); });
  const auto port = PluggedUsbDevice::plug(bench.system, *other);
  ASSERT_TRUE(port) << port.error().message;

  const auto source = open_seek(second);

  ASSERT_TRUE(source && source->start());
  const auto frame = source->next(patience);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(cv::countNonZero(frame->counts != 5), 0);
}

TEST(SeekCameras, AnAbsentOneIsNotFoundAndThoseSeenAreNamed) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);

  const auto source = usb_backend()->open("usb:SEEK-Compact-NOBODY");

  expect_not_found(source, seek_id(config));
}

TEST(SeekCameras, ASecondProgramIsToldThatTheCameraIsBusy) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto first = open_seek(config);
  ASSERT_TRUE(first && first->start());

  const auto second = usb_backend()->open(seek_id(config));

  expect_not_found(second, "busy");
}

TEST(SeekCameras, LeftAwakeByACrashedProgramAreInitialisedAgain) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const std::vector<std::uint8_t> awake{1, 0};
  ASSERT_TRUE(
      bench.camera->control({.request_type = 0x41, .request = 0x3C, .value = 0, .index = 0, .length = 2}, awake));

  const auto source = open_seek(config);

  ASSERT_TRUE(source);
  const auto started = source->start();
  EXPECT_TRUE(started) << started.error().message;
}

TEST(SeekScale, IsWhatTheUserStates) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source);

  expect_to_take_a_stated_scale(*source);
}

TEST(SeekPicture, HasItsDeadPixelsFilledAndTheirNumberTold) {
  auto config = fast(SeekModel::compact);
  config.dead = {{10, 10}, {11, 10}, {0, 0}};
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());

  const auto frame = source->next(patience);

  ASSERT_TRUE(frame) << frame.error().message;
  const cv::Mat1w exposed = seek_picture(config.model, seek_calibration_frames);
  EXPECT_EQ(source->info().settings.at("DeadPixels"), "3");
  EXPECT_EQ(frame->counts(10, 10), (exposed(10, 9) + exposed(9, 10) + exposed(11, 10)) / 3);
  EXPECT_EQ(frame->counts(0, 0), (exposed(0, 1) + exposed(1, 0)) / 2);
  EXPECT_EQ(cv::countNonZero(frame->counts != exposed), 3);
}

TEST(SeekShutter, FramesAreOfACorrectionAndThePicturesAfterThemTellItsTime) {
  auto config = fast(SeekModel::compact);
  config.shutter_interval_frames = 5;
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());

  double before = -1;
  for (int k = 0; k < 30; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    const bool shutter = k % 6 == 5;
    ASSERT_EQ(frame->correction, shutter ? CorrectionState::running : CorrectionState::idle) << k;
    if (shutter) {
      EXPECT_EQ(frame->since_correction_s, 0);
    }
    if (!shutter && k % 6 != 0) {
      EXPECT_GT(frame->since_correction_s, before);
    }
    before = frame->since_correction_s;
  }
}

TEST(SeekStreamOf, LostExposuresIsAGapOfTheirNumber) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());

  expect_gap_of_lost_exposures(*source, [&](unsigned count) { bench.camera->lose_exposures(count); });
}

TEST(SeekStreamOf, FramesThatFoundTheBuffersFullAreUnread) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());

  expect_unread_behind_a_slow_reader(
      *source, [&] { return bench.camera->exposures(); }, 128,
      [&](unsigned count) { bench.camera->lose_exposures(count); });
}

TEST(SeekStreamOf, AFrameWithMissingBytesIsIncompleteAndTheNextIsGood) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());
  auto last = source->next(patience);
  ASSERT_TRUE(last);

  bench.camera->truncate_next_frame(512 * 7);

  auto frame = source->next(patience);
  for (int k = 0; k < 100 && frame && frame->status == FrameStatus::complete; ++k) {
    last = frame;
    frame = source->next(patience);
  }
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->status, FrameStatus::incomplete);
  EXPECT_EQ(frame->sequence, last->sequence + 1);
  const auto next = source->next(patience);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->status, FrameStatus::complete);
  EXPECT_EQ(next->sequence, frame->sequence + 1);
}

TEST(SeekHotPlug, APulledCableIsDisconnectedAndTheSourceStaysDead) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.port->unplug();

  const auto next = end_of(*source);
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->start().error().code, ErrorCode::disconnected);
  EXPECT_EQ(source->get("Width").error().code, ErrorCode::disconnected);
}

TEST(SeekHotPlug, ADeviceThatVanishesWithItsPortIsDisconnectedToo) {
  const auto config = fast(SeekModel::compact);
  auto bench = plug_seek(config);
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.port.reset();

  const auto next = end_of(*source);
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
}

TEST(SeekHotPlug, ACameraThatIsPluggedInAgainIsOpened) {
  const auto config = fast(SeekModel::compact);
  auto bench = plug_seek(config);
  bench.port->unplug();

  auto port = PluggedUsbDevice::plug(bench.system, bench.camera);

  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_TRUE(source->next(patience));
}

}  // namespace
}  // namespace todbench
