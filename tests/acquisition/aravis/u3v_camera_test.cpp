// The USB3 Vision back end against an emulated camera: real Aravis on real libusb, on an emulated bus.
#include <gmock/gmock.h>

#include <cstring>

#include "acquisition/aravis/aravis_backend.h"
#include "sim_devices/lab/usb/u3v_camera.h"
#include "tests/acquisition/usb/usb_test_support.h"
#include "tests/acquisition/v4l2/video_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing_support::shared_system;
using testing_support::video_picture;

/// Far longer than any frame takes on a loaded machine; a test that waits this long has failed.
constexpr auto patience = 20s;

U3vCameraConfig small() {
  U3vCameraConfig config;
  config.width = 160;
  config.height = 120;
  config.frame_rate_hz = 200;
  return config;
}

struct U3vBench {
  std::shared_ptr<U3vCamera> camera;
  std::unique_ptr<PluggedUsbDevice> port;
};

U3vBench plug_u3v(const U3vCameraConfig& config) {
  U3vBench bench;
  auto camera = U3vCamera::create(config, [config](std::uint64_t index) {
    return video_picture(index, config.width, config.height, config.significant_bits);
  });
  if (!camera) {
    ADD_FAILURE() << camera.error().message;
    return bench;
  }
  bench.camera = *camera;
  auto port = PluggedUsbDevice::plug(shared_system(), bench.camera);
  if (!port) {
    ADD_FAILURE() << port.error().message;
    return bench;
  }
  bench.port = std::move(*port);
  return bench;
}

std::unique_ptr<CameraBackend> backend() {
  return aravis_backend({.transport = AravisTransport::usb3_vision});
}

std::unique_ptr<FrameSource> open_u3v(const U3vCameraConfig& config) {
  auto source = backend()->open("u3v:" + config.vendor + "-" + config.serial);
  if (!source) {
    ADD_FAILURE() << source.error().message;
    return nullptr;
  }
  return std::move(*source);
}

bool same_pixels(const cv::Mat1w& a, const cv::Mat1w& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

/// Exposure since power-up of a frame, from the camera's clock.
std::uint64_t exposure_of(const Frame& frame, double frame_rate_hz) {
  return static_cast<std::uint64_t>(std::llround(static_cast<double>(frame.device_time_ns) * 1e-9 * frame_rate_hz)) - 1;
}

class U3vPixels : public testing::TestWithParam<int> {};

TEST_P(U3vPixels, AHundredFramesEqualTheirExposures) {
  auto config = small();
  config.significant_bits = GetParam();
  const auto bench = plug_u3v(config);
  const auto source = open_u3v(config);
  ASSERT_TRUE(source && source->start());

  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_EQ(frame->sequence, k);
    ASSERT_EQ(frame->significant_bits, GetParam());
    ASSERT_TRUE(same_pixels(frame->counts, video_picture(exposure_of(*frame, 200), 160, 120, GetParam())));
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, U3vPixels, testing::Values(14, 16), testing::PrintToStringParamName());

TEST(U3vCameras, AreListedByVendorAndSerial) {
  const auto bench = plug_u3v(small());

  const auto cameras = backend()->list();

  ASSERT_TRUE(cameras) << cameras.error().message;
  ASSERT_EQ(cameras->size(), 1U);
  EXPECT_EQ(cameras->front().id, "u3v:todbench-TB0001");
  EXPECT_EQ(cameras->front().transport, "USB3 Vision");
}

TEST(U3vCameras, WithAZippedDescriptionAreReadToo) {
  auto config = small();
  config.description = U3vDescription::zipped;
  const auto bench = plug_u3v(config);

  const auto source = open_u3v(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().width, 160);
  EXPECT_EQ(source->info().model, "Emulated U3V");
}

TEST(U3vCameras, ThatAreAbsentAreNotFound) {
  const auto source = backend()->open("u3v:Nobody-7");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
}

TEST(U3vCameras, ASecondProgramCannotOpenABusyOne) {
  const auto bench = plug_u3v(small());
  const auto first = open_u3v(small());
  ASSERT_TRUE(first);

  const auto second = backend()->open("u3v:todbench-TB0001");

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::not_found);
}

TEST(U3vScale, IsLinearAsTheCameraSays) {
  auto config = small();
  config.offset_k = 250;
  const auto bench = plug_u3v(config);

  const auto source = open_u3v(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 0.01, .offset_k = 250}).value());
  EXPECT_EQ(source->info().settings.at("IRFormat"), "TemperatureLinear10mK");
}

TEST(U3vCorrection, IsCommandedAndFreezesThePicture) {
  auto config = small();
  config.nuc_freeze_frames = 5;
  const auto bench = plug_u3v(config);
  const auto source = open_u3v(config);
  ASSERT_TRUE(source && source->start());
  auto last = source->next(patience);
  ASSERT_TRUE(last);

  const auto corrected = source->correct_nonuniformity();

  ASSERT_TRUE(corrected) << corrected.error().message;
  EXPECT_EQ(bench.camera->nonuniformity_corrections(), 1U);
  int frozen = 0;
  for (int k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    if (same_pixels(frame->counts, last->counts)) ++frozen;
    last = frame;
  }
  EXPECT_EQ(frozen, 5);
}

TEST(U3vStream, LostExposuresAreAGapOfTheirNumber) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
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

TEST(U3vStream, AFrameWithMissingBytesIsNotComplete) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->truncate_next_frame(1000);

  FrameStatus status = FrameStatus::complete;
  for (int k = 0; k < 100 && status == FrameStatus::complete; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    status = frame->status;
  }
  EXPECT_NE(status, FrameStatus::complete);
}

TEST(U3vHotPlug, APulledCableIsDisconnected) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.port->unplug();

  auto next = source->next(patience);
  for (int k = 0; k < 1000 && next; ++k) next = source->next(patience);
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
}

// --- the camera by itself: what a host may send it ------------------------------------------------------------------

std::vector<std::uint8_t> read_command(std::uint64_t address, std::uint16_t size) {
  std::vector<std::uint8_t> bytes{'U', '3', 'V', 'C', 0, 0x40, 0, 8, 12, 0, 7, 0};
  for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::uint8_t>(address >> (8 * k) & 0xFFU));
  bytes.insert(bytes.end(), {0, 0, static_cast<std::uint8_t>(size & 0xFFU), static_cast<std::uint8_t>(size >> 8U)});
  return bytes;
}

std::uint16_t status_of(U3vCamera& camera, const std::vector<std::uint8_t>& command) {
  EXPECT_TRUE(camera.bulk_out(0x01, command));
  const auto answer = camera.bulk_in(0x81, 2000, {});
  return answer && answer->size() >= 12 ? static_cast<std::uint16_t>((*answer)[4] | (*answer)[5] << 8U) : 0xFFFF;
}

TEST(U3vControl, RefusesWhatIsOutsideItsRegisters) {
  const auto camera = U3vCamera::create(small(), [](std::uint64_t) { return cv::Mat1w(); });
  ASSERT_TRUE(camera);

  EXPECT_EQ(status_of(**camera, read_command(0x4, 64)), 0);
  EXPECT_EQ(status_of(**camera, read_command(0x2FFF, 2)), 0x8003);
  EXPECT_EQ(status_of(**camera, read_command(0xFFFFFFFFFFFFFFFF, 4)), 0x8003);
  EXPECT_EQ(status_of(**camera, read_command(0x4, 0xFFFF)), 0x8002);
}

TEST(U3vControl, SurvivesEveryBeginningOfACommandAndDoesNotKeepAnswersForEver) {
  const auto camera = U3vCamera::create(small(), [](std::uint64_t) { return cv::Mat1w(); });
  ASSERT_TRUE(camera);
  const auto whole = read_command(0x4, 64);

  for (std::size_t size = 0; size < whole.size(); ++size) {
    for (int k = 0; k < 20; ++k) {
      EXPECT_TRUE((*camera)->bulk_out(0x01, std::span(whole).first(size)));
    }
  }

  int kept = 0;
  std::stop_source stop;
  stop.request_stop();
  while ((*camera)->bulk_in(0x81, 2000, stop.get_token())) ++kept;
  EXPECT_LE(kept, 8);
}

}  // namespace
}  // namespace todbench
