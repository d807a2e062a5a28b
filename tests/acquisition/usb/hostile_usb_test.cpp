// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras on USB that misbehave at any step of their conversation, or are unplugged there: every call comes to an end,
// and no picture that was not exposed is called complete.
#include <gtest/gtest.h>

#include <ostream>
#include <thread>
#include <tuple>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/usb/usb_backend.h"
#include "sim_devices/lab/usb/u3v_camera.h"
#include "tests/support/hostile_usb_device.h"
#include "tests/support/usb_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;

enum class Kind { seek, u3v };

constexpr int small_width = 160, small_height = 120;

SeekCameraConfig seek_config() {
  SeekCameraConfig config;
  config.frame_rate_hz = 500;
  return config;
}

U3vCameraConfig u3v_config() {
  U3vCameraConfig config;
  config.width = small_width;
  config.height = small_height;
  config.frame_rate_hz = 200;
  return config;
}

std::shared_ptr<UsbDevice> honest(Kind kind) {
  if (kind == Kind::seek) {
    const auto config = seek_config();
    return *SeekCamera::create(config, [config](std::uint64_t index) { return seek_picture(config.model, index); });
  }
  return *U3vCamera::create(u3v_config(), [](std::uint64_t index) {
    return test_picture(index, small_width, small_height, u3v_config().significant_bits);
  });
}

Result<std::unique_ptr<FrameSource>> open_any(Kind kind) {
  return kind == Kind::seek ? usb_backend()->open(seek_id(seek_config()))
                            : aravis_backend({.transport = AravisTransport::usb3_vision})->open("u3v:todbench-TB0001");
}

/// Whether the picture is one of those that the camera has exposed.
bool was_exposed(Kind kind, const Frame& frame) {
  if (kind == Kind::u3v) {
    return same_pixels(frame.counts, test_picture(exposure_of(frame, 200), small_width, small_height, 14));
  }
  for (std::uint64_t index = 0; index < 200; ++index)
    if (same_pixels(frame.counts, seek_picture(seek_config().model, index))) return true;
  return false;
}

/// Opens, takes some frames and closes, as far as it goes. Complete pictures that were never exposed.
int false_pictures_of_a_conversation(Kind kind) {
  int wrong = 0;
  auto source = open_any(kind);
  if (!source) return 0;
  if (!(*source)->start()) return 0;
  int silent = 0;
  for (int k = 0; k < 12 && silent < 2; ++k) {
    const auto frame = (*source)->next(300ms);
    if (!frame && frame.error().code != ErrorCode::timeout) break;
    silent += frame ? 0 : 1;
    const bool picture =
        frame && frame->status == FrameStatus::complete && frame->correction != CorrectionState::running;
    wrong += picture && !was_exposed(kind, *frame) ? 1 : 0;
  }
  (*source)->stop();
  return wrong;
}

/// Transfers of an honest camera from opening to the twelfth frame.
int steps_of_a_conversation(Kind kind) {
  const auto device = std::make_shared<HostileUsbDevice>(honest(kind), Misbehaviour::stalls, -1);
  const auto port = PluggedUsbDevice::plug(shared_system(), device);
  EXPECT_TRUE(port) << port.error().message;
  EXPECT_EQ(false_pictures_of_a_conversation(kind), 0);
  return device->steps();
}

/// Steps to try, denser at the beginning, where a camera is made known. A camera that stays as it is from a step on
/// keeps its client waiting for seconds at each: three will do.
std::vector<int> some_steps(int all, Misbehaviour misbehaviour) {
  if (misbehaviour == Misbehaviour::drips_after || misbehaviour == Misbehaviour::silent_after) {
    return {0, all / 2, all - 10};
  }
  std::vector<int> steps;
  for (int step = 0; step < all; step += 1 + step) steps.push_back(step);
  return steps;
}

class HostileUsb : public testing::TestWithParam<std::tuple<Kind, Misbehaviour>> {};

TEST_P(HostileUsb, EndsEveryCallAndPassesNoFalsePicture) {
  const auto [kind, misbehaviour] = GetParam();
  for (const int step : some_steps(steps_of_a_conversation(kind), misbehaviour)) {
    SCOPED_TRACE(step);
    const auto device = std::make_shared<HostileUsbDevice>(honest(kind), misbehaviour, step);
    const auto port = PluggedUsbDevice::plug(shared_system(), device);
    ASSERT_TRUE(port) << port.error().message;

    const int wrong = false_pictures_of_a_conversation(kind);

    // Pixels have no checksum on USB: exchanged ones cannot be seen.
    if (misbehaviour != Misbehaviour::garbage) {
      EXPECT_EQ(wrong, 0);
    }
  }
}

std::string name_of(Kind kind) {
  return kind == Kind::seek ? "seek" : "u3v";
}

std::string name_of(Misbehaviour misbehaviour) {
  constexpr const char* names[] = {"stalls",      "stalls_after", "short_answer", "no_bytes",
                                   "drips_after", "is_silent",    "silent_after", "garbage"};
  return names[static_cast<std::size_t>(misbehaviour)];
}

INSTANTIATE_TEST_SUITE_P(Every, HostileUsb,
                         testing::Combine(testing::Values(Kind::seek, Kind::u3v),
                                          testing::Values(Misbehaviour::stalls, Misbehaviour::stalls_after,
                                                          Misbehaviour::short_answer, Misbehaviour::no_bytes,
                                                          Misbehaviour::drips_after, Misbehaviour::is_silent,
                                                          Misbehaviour::silent_after, Misbehaviour::garbage)),
                         [](const auto& parameters) {
                           return name_of(std::get<0>(parameters.param)) + "_" + name_of(std::get<1>(parameters.param));
                         });

class UnpluggedUsb : public testing::TestWithParam<Kind> {};

TEST_P(UnpluggedUsb, AtEveryStepEndsEveryCall) {
  const Kind kind = GetParam();
  for (const int step : some_steps(steps_of_a_conversation(kind), Misbehaviour::stalls)) {
    SCOPED_TRACE(step);
    const auto device = std::make_shared<HostileUsbDevice>(honest(kind), Misbehaviour::stalls, -1);
    auto port = PluggedUsbDevice::plug(shared_system(), device);
    ASSERT_TRUE(port) << port.error().message;
    std::jthread hand([&](const std::stop_token& stop) {
      if (device->wait_for(step, stop)) (*port)->unplug();
    });

    EXPECT_EQ(false_pictures_of_a_conversation(kind), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, UnpluggedUsb, testing::Values(Kind::seek, Kind::u3v),
                         [](const auto& parameters) { return name_of(parameters.param); });

}  // namespace
}  // namespace todbench
