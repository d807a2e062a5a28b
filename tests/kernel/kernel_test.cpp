// SPDX-License-Identifier: GPL-3.0-or-later
// Runs as the first program of a virtual machine, as root: emulated cameras are plugged into the kernel's virtual USB
// host controller. The real uvcvideo driver stands between them and the V4L2 back end, the real usbfs between them and
// libusb under the USB3 Vision back end.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/v4l2/v4l2_backend.h"
#include "acquisition/v4l2/video_listing.h"
#include "sim_devices/lab/usb/u3v_camera.h"
#include "tests/support/usbip_server.h"
#include "tests/support/uvc_camera.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;

/// A virtual machine without hardware support is thirty times slower than its host.
constexpr auto patience = 180s;

/// Counts of 14 bits: temperature rows of 1/64 K stay below 256 K, as those of a real camera stay below 453 K.
constexpr unsigned count_mask = 0x3FFF;

cv::Mat1w picture(std::uint64_t index, int width, int height) {
  cv::Mat1w out(height, width);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto value =
          257U * static_cast<unsigned>(index) + 7U * static_cast<unsigned>(x) + 1031U * static_cast<unsigned>(y);
      out(y, x) = static_cast<ushort>(value & count_mask);
    }
  }
  return out;
}

/// 257 * 65281 = 1 modulo 2^16 and 2^14: the first pixel tells which exposure a picture is.
std::uint64_t exposure_of(const cv::Mat1w& counts) {
  return (counts(0, 0) * 65281U) & count_mask;
}

/// A camera plugged into a port, and what sees it.
struct Plugged {
  std::shared_ptr<UvcCamera> camera;
  std::unique_ptr<UsbIpServer> server;
};

VideoCameraConfig config_of(VideoCameraKind kind, int width, int height) {
  VideoCameraConfig config;
  config.kind = kind;
  config.width = width;
  config.height = height;
  config.frame_rate_hz = 25;
  config.model = "Emulated UVC";
  config.serial = "K0001";
  return config;
}

Plugged plug(const VideoCameraConfig& config, int port) {
  auto camera =
      UvcCamera::create(config, [w = config.width, h = config.height](std::uint64_t k) { return picture(k, w, h); });
  EXPECT_TRUE(camera) << camera.error().message;
  Plugged plugged{.camera = std::move(*camera), .server = nullptr};
  auto server = plug_into_kernel(plugged.camera, port);
  EXPECT_TRUE(server) << server.error().message;
  if (server) plugged.server = std::move(*server);
  return plugged;
}

/// Opens as soon as the kernel has made the device; its arrival wakes the wait.
std::unique_ptr<FrameSource> open_when_there(VideoWatch& arrivals, const std::string& id) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::string last;
  while (std::chrono::steady_clock::now() < deadline) {
    auto source = v4l2_backend()->open(id);
    if (source) return std::move(*source);
    last = source.error().message;
    static_cast<void>(arrivals.next(1s));
  }
  ADD_FAILURE() << last;
  return nullptr;
}

/// A busy machine has two effects. The driver drops a frame while the program has given back no buffer; such a frame
/// must show as a gap of Frame::sequence. The camera waits until its frame has been fetched; a long wait also counts as
/// a gap, because a camera with a constant rate would have exposed in this time. So the sequence advances at least as
/// far as the exposures.
void expect_frames_equal_their_exposures(FrameSource& source, int count) {
  const auto started = source.start();
  ASSERT_TRUE(started) << started.error().message;
  std::uint64_t last_exposure = 0, last_sequence = 0;
  for (int k = 0; k < count; ++k) {
    const auto frame = source.next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    const auto exposure = exposure_of(frame->counts);
    const cv::Mat1w expected = picture(exposure, frame->counts.cols, frame->counts.rows);
    ASSERT_EQ(cv::countNonZero(frame->counts != expected), 0) << "exposure " << exposure;
    if (k > 0) {
      ASSERT_GT(exposure, last_exposure) << "frame " << k;
      ASSERT_GE(frame->sequence - last_sequence, exposure - last_exposure) << "frame " << k;
    }
    last_exposure = exposure, last_sequence = frame->sequence;
  }
}

class Kernel : public testing::Test {
 protected:
  VideoWatch arrivals_ = std::move(*VideoWatch::create());
};

TEST_F(Kernel, UvcvideoDeliversTheFramesOfALeptonByteForByte) {
  const auto config = config_of(VideoCameraKind::lepton, 160, 120);
  const Plugged plugged = plug(config, 0);
  ASSERT_TRUE(plugged.server);

  const auto source = open_when_there(arrivals_, "v4l2:todbench-Emulated_UVC-K0001");

  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().transport, testing::HasSubstr("uvcvideo"));
  EXPECT_EQ(source->info().height, 120);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 0.01}).value());
  EXPECT_NEAR(source->info().frame_rate_hz, 25, 0.01);
  expect_frames_equal_their_exposures(*source, 50);
}

TEST_F(Kernel, UvcvideoDeliversTemperatureRowsByteForByte) {
  auto config = config_of(VideoCameraKind::temperature_rows, 256, 192);
  config.serial = "K0002";
  const Plugged plugged = plug(config, 1);
  ASSERT_TRUE(plugged.server);

  const auto source = open_when_there(arrivals_, "v4l2:todbench-Emulated_UVC-K0002");

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().width, 256);
  EXPECT_EQ(source->info().height, 192);
  EXPECT_EQ(source->info().scale, RadiometricScale::linear({.kelvin_per_count = 1.0 / 64}).value());
  expect_frames_equal_their_exposures(*source, 25);
}

TEST_F(Kernel, ACameraStartsAgainAfterStop) {
  auto config = config_of(VideoCameraKind::y16, 160, 120);
  config.serial = "K0003";
  const Plugged plugged = plug(config, 2);
  const auto source = open_when_there(arrivals_, "v4l2:todbench-Emulated_UVC-K0003");
  ASSERT_TRUE(source);
  expect_frames_equal_their_exposures(*source, 5);

  source->stop();

  EXPECT_EQ(source->next(0ms).error().code, ErrorCode::interrupted);
  expect_frames_equal_their_exposures(*source, 5);
}

TEST_F(Kernel, AnUnpluggedCameraIsDisconnectedAndFoundAgainBySerial) {
  auto config = config_of(VideoCameraKind::y16, 160, 120);
  config.serial = "K0004";
  Plugged plugged = plug(config, 3);
  const auto source = open_when_there(arrivals_, "v4l2:todbench-Emulated_UVC-K0004");
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  plugged.server.reset();

  auto next = source->next(patience);
  while (next) next = source->next(patience);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
  const Plugged again = plug(config, 4);
  const auto found = open_when_there(arrivals_, "v4l2:todbench-Emulated_UVC-K0004");
  ASSERT_TRUE(found);
  expect_frames_equal_their_exposures(*found, 5);
}

/// USB3 Vision cameras behind the kernel's usbfs. libusb lists what it found when Aravis first asked for it and what
/// udevd has told since; there is no udevd in the machine, so all cameras of the suite are plugged in before.
class KernelUsb3Vision : public testing::Test {
 protected:
  static constexpr int first_port = 5;
  static constexpr int cameras = 2;

  static void SetUpTestSuite() {
    for (int k = 0; k < cameras; ++k) {
      U3vCameraConfig config;
      config.serial = "K100" + std::to_string(k);
      config.width = 160;
      config.height = 120;
      config.significant_bits = 16;
      config.frame_rate_hz = 25;
      auto camera = U3vCamera::create(config, [](std::uint64_t index) { return picture(index, 160, 120); });
      ASSERT_TRUE(camera) << camera.error().message;
      auto server = plug_into_kernel(*camera, first_port + k);
      ASSERT_TRUE(server) << server.error().message;
      servers().push_back(std::move(*server));
      ASSERT_TRUE(wait_for_interfaces(first_port + k));
    }
  }
  static void TearDownTestSuite() { servers().clear(); }

  static std::vector<std::unique_ptr<UsbIpServer>>& servers() {
    static std::vector<std::unique_ptr<UsbIpServer>> all;
    return all;
  }

  /// Waits until the kernel has read the descriptors and made both interfaces, control and stream.
  static bool wait_for_interfaces(int port) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    // Ports of the hub of the first bus count from 1.
    const std::string stream = "/sys/bus/usb/devices/1-" + std::to_string(port + 1) + ":1.1";
    while (!std::filesystem::exists(stream)) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(20ms);
    }
    return true;
  }

  /// Aravis waits 32 ms for each of its first answers, five times: little where every instruction is emulated.
  static std::unique_ptr<FrameSource> open(int camera) {
    const auto backend = aravis_backend({.transport = AravisTransport::usb3_vision});
    const auto deadline = std::chrono::steady_clock::now() + patience;
    for (;;) {
      auto source = backend->open("u3v:todbench-K100" + std::to_string(camera));
      if (source) return std::move(*source);
      if (std::chrono::steady_clock::now() > deadline) {
        ADD_FAILURE() << source.error().message;
        return nullptr;
      }
    }
  }
};

TEST_F(KernelUsb3Vision, UsbfsDeliversTheFramesByteForByte) {
  const auto source = open(0);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().transport, "USB3 Vision");
  EXPECT_EQ(source->info().width, 160);
  EXPECT_NEAR(source->info().frame_rate_hz, 25, 0.01);
  expect_frames_equal_their_exposures(*source, 25);
}

TEST_F(KernelUsb3Vision, ACameraStartsAgainAfterStop) {
  const auto source = open(0);
  ASSERT_TRUE(source);
  expect_frames_equal_their_exposures(*source, 5);

  source->stop();

  EXPECT_EQ(source->next(0ms).error().code, ErrorCode::interrupted);
  expect_frames_equal_their_exposures(*source, 5);
}

TEST_F(KernelUsb3Vision, AnUnpluggedCameraIsDisconnected) {
  const auto source = open(1);
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  servers().at(1).reset();

  auto next = source->next(patience);
  while (next) next = source->next(patience);
  EXPECT_EQ(next.error().code, ErrorCode::disconnected);
}

}  // namespace
}  // namespace todbench
