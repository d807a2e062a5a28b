// SPDX-License-Identifier: GPL-3.0-or-later
// The USB3 Vision back end against an emulated camera: real Aravis on real libusb, on an emulated bus.
#include <gmock/gmock.h>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/core/camera_id.h"
#include "sim_devices/lab/usb/u3v_camera.h"
#include "tests/support/usb_test_support.h"

namespace todbench {
namespace {

using namespace testing_support;

U3vCameraConfig small() {
  U3vCameraConfig config;
  config.width = 160;
  config.height = 120;
  config.frame_rate_hz = 200;
  return config;
}

UsbBench<U3vCamera> plug_u3v(const U3vCameraConfig& config) {
  return plug(U3vCamera::create(config, [config](std::uint64_t index) {
    return test_picture(index, config.width, config.height, config.significant_bits);
  }));
}

std::unique_ptr<CameraBackend> backend() {
  return aravis_backend({.transport = AravisTransport::usb3_vision});
}

std::unique_ptr<FrameSource> open_u3v(const U3vCameraConfig& config) {
  return opened(backend()->open(camera_id(camera_scheme::u3v, {config.vendor, config.serial})));
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
    ASSERT_TRUE(same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 160, 120, GetParam())));
  }
}

INSTANTIATE_TEST_SUITE_P(Bits, U3vPixels, testing::Values(14, 16), testing::PrintToStringParamName());

TEST(U3vCameras, AreListedByVendorAndSerial) {
  const auto bench = plug_u3v(small());

  const auto camera = only_camera(*backend());

  EXPECT_EQ(camera.id, "u3v:todbench-TB0001");
  EXPECT_EQ(camera.transport, "USB3 Vision");
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

/// The refusal of a camera; fails the test where it is opened.
std::string refusal_of(const U3vCameraConfig& config) {
  const auto bench = plug_u3v(config);
  const auto source = backend()->open("u3v:todbench-TB0001");
  expect_not_found(source);
  return source ? std::string() : source.error().message;
}

TEST(HostileU3vCameras, AreRefusedWithASentence) {
  auto config = small();
  config.description_text =
      "<RegisterDescription><Integer Name=\"Width\"><pValue>Width</pValue></Integer></RegisterDescription>";
  EXPECT_THAT(refusal_of(config), testing::HasSubstr("Width: its value has a circular reference"));
  config.description_text =
      "<RegisterDescription><IntReg Name=\"R\"><Address>0</Address><Length>-1</Length></IntReg>"
      "</RegisterDescription>";
  EXPECT_THAT(refusal_of(config), testing::HasSubstr("its length is -1 bytes"));
}

TEST(HostileU3vCameras, ThatStateImmenseDescriptionsAreRefused) {
  auto config = small();
  for (const std::uint64_t bytes : {std::uint64_t{1} << 63U, std::uint64_t{20} << 30U, std::uint64_t{17} << 20U}) {
    config.stated_description_bytes = bytes;

    EXPECT_THAT(refusal_of(config), testing::HasSubstr("bytes, expected 1 ... ")) << bytes;
  }
}

TEST(HostileU3vCameras, WithADamagedArchiveAreRefused) {
  auto config = small();
  config.description = U3vDescription::zipped;
  config.stated_description_bytes = 400;

  EXPECT_THAT(refusal_of(config), testing::HasSubstr("zipped description"));
}

TEST(U3vCameras, ThatAreAbsentAreNotFound) {
  const auto source = backend()->open("u3v:Nobody-7");

  expect_not_found(source);
}

TEST(U3vCameras, ASecondProgramCannotOpenABusyOne) {
  const auto bench = plug_u3v(small());
  const auto first = open_u3v(small());
  ASSERT_TRUE(first);

  const auto second = backend()->open("u3v:todbench-TB0001");

  expect_not_found(second);
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

  expect_gap_of_lost_exposures(*source, [&](unsigned count) { bench.camera->lose_exposures(count); });
}

TEST(U3vStream, StatedPaddingIsTakenOutOfThePicture) {
  for (const int padding : {8, 2, 1, 160}) {
    auto config = small();
    config.row_padding_bytes = padding;
    const auto bench = plug_u3v(config);
    const auto source = open_u3v(config);
    ASSERT_TRUE(source && source->start());

    for (int k = 0; k < 20; ++k) {
      const auto frame = source->next(patience);
      ASSERT_TRUE(frame) << frame.error().message;
      ASSERT_EQ(frame->status, FrameStatus::complete);
      ASSERT_TRUE(same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 160, 120, 14)));
    }
  }
}

TEST(U3vStream, PaddingThatIsNotStatedMakesEveryFrameOneOfAWrongSize) {
  auto config = small();
  config.row_padding_bytes = 8;
  config.states_padding = false;
  const auto bench = plug_u3v(config);
  const auto source = open_u3v(config);
  ASSERT_TRUE(source && source->start());

  for (int k = 0; k < 20; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::wrong_size);
  }
}

TEST(U3vStream, FramesThatAreLargerThanStatedAreNotComplete) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start() && source->next(patience));
  for (const std::size_t surplus : {1U, 8U, 300U, 5000U, 70000U}) {
    bench.camera->lengthen_next_frame(surplus);

    int odd = 0;
    for (int k = 0; k < 15; ++k) {
      const auto frame = source->next(patience);
      ASSERT_TRUE(frame) << frame.error().message;
      if (frame->status != FrameStatus::complete) {
        ++odd;
        continue;
      }
      ASSERT_TRUE(same_pixels(frame->counts, test_picture(exposure_of(*frame, 200), 160, 120, 14)));
    }
    EXPECT_EQ(odd, 1) << surplus;
  }
}

TEST(U3vStream, NumbersThatBeginAnewHideNoLossAndInventNone) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start());
  auto last = source->next(patience);
  for (int k = 0; k < 40; ++k) last = source->next(patience);
  ASSERT_TRUE(last);
  // The exposures that are lost here are in the camera's clock, not in its numbers.
  bench.camera->lose_exposures(7);
  bench.camera->restart_numbers(0);

  int restarts = 0;
  for (int k = 0; k < 40; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    restarts += frame->numbering == Numbering::counted ? 0 : 1;
    ASSERT_EQ(frame->sequence - last->sequence, exposure_of(*frame, 200) - exposure_of(*last, 200));
    last = frame;
  }

  EXPECT_EQ(restarts, 1);
}

TEST(U3vIdentity, ComesFromTheBootstrapRegistersWhereTheDescriptionHasNone) {
  auto config = small();
  config.identity_nodes = U3vIdentityNodes::absent;
  const auto bench = plug_u3v(config);

  const auto source = open_u3v(config);

  ASSERT_TRUE(source);
  EXPECT_EQ(source->info().id, "u3v:todbench-TB0001");
  EXPECT_EQ(source->info().vendor, "todbench");
  EXPECT_EQ(source->info().model, "Emulated U3V");
  EXPECT_EQ(source->info().serial, "TB0001");
  EXPECT_EQ(source->info().firmware, "1.0");
}

/// A register of the stream interface and what it says.
class FalseRegisters : public testing::TestWithParam<std::pair<std::uint64_t, std::uint32_t>> {};

TEST_P(FalseRegisters, AreRefusedBeforeAravisCalculatesWithThem) {
  auto config = small();
  config.false_registers = {GetParam()};
  const auto bench = plug_u3v(config);

  const auto source = backend()->open("u3v:todbench-TB0001");

  expect_not_found(source);
}

INSTANTIATE_TEST_SUITE_P(U3v, FalseRegisters,
                         testing::Values(std::pair(0x1108U, 0U),           // a payload of nothing
                                         std::pair(0x110CU, 1U),           // of 4 GiB and more
                                         std::pair(0x1110U, 0xFFFFFFFFU),  // the leader
                                         std::pair(0x1114U, 0x7FFFFFFFU),  // the trailer
                                         std::pair(0x1100U, 0xFF000000U),  // an alignment of 2^255
                                         std::pair(0x1100U, 0x1F000000U)));

TEST(U3vStream, AFrameWithMissingBytesIsNotComplete) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.camera->truncate_next_frame(1000);

  const auto frame = next_damaged(*source);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_NE(frame->status, FrameStatus::complete);
}

TEST(U3vHotPlug, APulledCableIsDisconnected) {
  const auto bench = plug_u3v(small());
  const auto source = open_u3v(small());
  ASSERT_TRUE(source && source->start());
  ASSERT_TRUE(source->next(patience));

  bench.port->unplug();

  const auto next = end_of(*source);
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
