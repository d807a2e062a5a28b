// The USB back end against an emulated Seek camera: real libusb calls of this process, on an emulated bus.
#include <gmock/gmock.h>

#include <algorithm>
#include <future>

#include "acquisition/core/integrity_gate.h"
#include "acquisition/usb/usb_backend.h"
#include "tests/acquisition/usb/usb_test_support.h"
#include "tests/support/parameter_names.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::open_seek;
using testing_support::plug_seek;
using testing_support::seek_id;
using testing_support::seek_picture;

/// Far longer than any frame takes on a loaded machine; a test that waits this long has failed.
constexpr auto patience = 20s;

SeekCameraConfig fast(SeekModel model) {
  SeekCameraConfig config;
  config.model = model;
  config.frame_rate_hz = 500;
  return config;
}

bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
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

  const auto cameras = usb_backend()->list();

  ASSERT_TRUE(cameras) << cameras.error().message;
  ASSERT_EQ(cameras->size(), 1U);
  EXPECT_EQ(cameras->front().id, "usb:SEEK-CompactPRO-0A_1B");
  EXPECT_EQ(cameras->front().address, bench.port->node());
}

TEST(SeekCameras, WithoutASerialNumberAreKnownByTheirChip) {
  auto config = fast(SeekModel::compact);
  config.serial = "";
  const auto bench = plug_seek(config);

  const auto cameras = usb_backend()->list();

  ASSERT_TRUE(cameras) << cameras.error().message;
  ASSERT_EQ(cameras->size(), 1U);
  EXPECT_EQ(cameras->front().id, "usb:SEEK-Compact-544230303031000102030405");
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

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr(seek_id(config)));
}

TEST(SeekCameras, ASecondProgramIsToldThatTheCameraIsBusy) {
  const auto config = fast(SeekModel::compact);
  const auto bench = plug_seek(config);
  const auto first = open_seek(config);
  ASSERT_TRUE(first && first->start());

  const auto second = usb_backend()->open(seek_id(config));

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::not_found);
  EXPECT_THAT(second.error().message, HasSubstr("busy"));
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
  EXPECT_FALSE(source->info().scale.calibrated());

  ASSERT_TRUE(source->set("TemperatureLinearScale", "0.04"));
  ASSERT_TRUE(source->set("TemperatureLinearOffset", "-10"));

  ASSERT_TRUE(source->start());
  const auto frame = source->next(patience);
  ASSERT_TRUE(frame);
  EXPECT_EQ(*frame->scale, RadiometricScale::linear({.kelvin_per_count = 0.04, .offset_k = -10}).value());
  EXPECT_EQ(source->set("TemperatureLinearScale", "0").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source->set("TemperatureLinearOffset", "warm").error().code, ErrorCode::invalid_input);
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
  auto last = source->next(patience);
  ASSERT_TRUE(last);

  bench.camera->lose_exposures(3);

  std::uint64_t gap = 0;
  for (int k = 0; k < 100 && gap == 0; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    gap = frame->sequence - last->sequence - 1;
    last = frame;
  }
  EXPECT_EQ(gap, 3U);
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

  auto next = source->next(patience);
  for (int k = 0; k < 100 && next; ++k) next = source->next(patience);
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

  auto next = source->next(patience);
  for (int k = 0; k < 100 && next; ++k) next = source->next(patience);
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
}

TEST(SeekHotPlug, ACameraThatIsPluggedInAgainIsWaitedForAndOpened) {
  const auto config = fast(SeekModel::compact);
  auto bench = plug_seek(config);
  bench.port->unplug();
  auto waiting = std::async(std::launch::async, [&] { return wait_for_usb_camera(seek_id(config), patience, {}); });

  auto port = PluggedUsbDevice::plug(bench.system, bench.camera);

  const auto arrived = waiting.get();
  EXPECT_TRUE(arrived) << arrived.error().message;
  const auto source = open_seek(config);
  ASSERT_TRUE(source && source->start());
  EXPECT_TRUE(source->next(patience));
}

TEST(SeekHotPlug, WaitingForACameraEndsOnRequest) {
  const auto bench = plug_seek(fast(SeekModel::compact));
  std::stop_source stop;
  stop.request_stop();

  EXPECT_EQ(wait_for_usb_camera("usb:SEEK-Compact-NOBODY", patience, stop.get_token()).error().code,
            ErrorCode::interrupted);
  EXPECT_EQ(wait_for_usb_camera("usb:SEEK-Compact-NOBODY", 1ms, {}).error().code, ErrorCode::timeout);
}

}  // namespace
}  // namespace todbench
