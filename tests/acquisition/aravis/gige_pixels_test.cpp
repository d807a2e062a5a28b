// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels over the wire: every format, whole streams byte for byte, real recordings.
#include <gmock/gmock.h>

#include <chrono>
#include <filesystem>

#include "acquisition/recording/flir_seq.h"
#include "acquisition/recording/raw_recording.h"
#include "sim_devices/sensor/sensor_model.h"
#include "tests/support/gige_test_support.h"
#include "tests/support/source_file.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

struct FormatCase {
  int bits;
  std::string wanted;
  std::string chosen;
  int significant_bits;
};

void PrintTo(const FormatCase& format, std::ostream* out) {
  *out << format.bits << " bits as " << format.chosen;
}

class GigePixelFormat : public testing::TestWithParam<FormatCase> {};

TEST_P(GigePixelFormat, CarriesEveryBit) {
  const auto& [bits, wanted, chosen, significant_bits] = GetParam();
  EmulatedGigeCameraConfig config;
  config.significant_bits = bits;
  const auto camera = start_camera(config);
  AravisOptions options;
  options.pixel_format = wanted;
  const auto source = open_camera(options);
  ASSERT_TRUE(source && source->start());

  const auto frame = source->next(patience);

  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(source->info().pixel_format, chosen);
  EXPECT_EQ(source->info().significant_bits, significant_bits);
  EXPECT_EQ(frame->significant_bits, significant_bits);
  cv::Mat1w expected = test_picture(exposure_index(*frame, 50), 320, 240, bits);
  for (auto& count : expected) count = std::min<ushort>(count, static_cast<ushort>((1 << significant_bits) - 1));
  EXPECT_TRUE(same_pixels(frame->counts, expected));
}

INSTANTIATE_TEST_SUITE_P(All, GigePixelFormat,
                         testing::Values(FormatCase{14, "", "Mono14", 14}, FormatCase{16, "", "Mono16", 16},
                                         FormatCase{14, "Mono16", "Mono16", 14},
                                         FormatCase{16, "Mono14", "Mono14", 14}),
                         [](const auto& test_case) {
                           return "Sensor" + std::to_string(test_case.param.bits) + "BitAsked" +
                                  (test_case.param.wanted.empty() ? "Nothing" : test_case.param.wanted);
                         });

TEST(GigePixels, RefusesAPixelFormatThatTheCameraDoesNotHave) {
  const auto camera = start_camera({});
  AravisOptions options;
  options.pixel_format = "Mono12";

  const auto source = aravis_backend(options)->open("gige:127.0.0.1");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::not_found);
  EXPECT_THAT(source.error().message, HasSubstr("Mono14, Mono16"));
}

TEST(GigePixels, TwoHundredConsecutiveFramesEqualTheExposuresByteForByteAcrossTheWrapOfTheFrameId) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 100;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  // The first id is 65400, so frame 136 is the first after the wrap.
  for (std::uint64_t k = 0; k < 200; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_EQ(frame->sequence, k);
    ASSERT_EQ(exposure_index(*frame, 100), k);
    ASSERT_TRUE(same_pixels(frame->counts, test_picture(k, 320, 240, 14))) << "frame " << k;
  }
}

TEST(GigePixels, AHundredFramesFromACameraInAnotherProcessEqualTheExposuresByteForByte) {
  const CameraProcess camera(100);
  ASSERT_TRUE(camera.started());
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->sequence, k);
    ASSERT_TRUE(same_pixels(frame->counts, test_picture(exposure_index(*frame, 100), 320, 240, 14))) << "frame " << k;
  }
}

TEST(GigePixels, AHundredFramesOfASimulatedSensorEqualItsExposuresByteForByte) {
  SensorSpec spec;
  spec.width = 160;
  spec.height = 120;
  const SensorModel sensor(spec, full_plan(spec, {}, {}), Accuracy::draft(), 7);
  PlateScene scene;
  scene.plate.triangles.push_back({.name = "one", .position_mm = {0, 0}, .size_mm = 20, .apex = Apex::up});
  scene.delta_t_k = 2;
  EmulatedGigeCameraConfig config;
  config.width = spec.width;
  config.height = spec.height;
  config.significant_bits = spec.bits;
  config.kelvin_per_count = spec.kelvin_per_count;
  config.offset_k = spec.offset_k;
  const auto camera =
      EmulatedGigeCamera::start(config, [&](std::uint64_t index) { return sensor.expose(scene, index); });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  for (std::uint64_t k = 0; k < 100; ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->sequence, k);
    ASSERT_TRUE(same_pixels(frame->counts, sensor.expose(scene, k))) << "frame " << k;
  }
  EXPECT_DOUBLE_EQ(source->info().scale.kelvin(5000).value(), spec.offset_k + 5000 * spec.kelvin_per_count);
}

TEST(GigePixels, ServesGeometriesThatDoNotFillThePacketsEvenly) {
  EmulatedGigeCameraConfig config;
  config.width = 161;
  config.height = 123;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  const auto frame = source->next(patience);

  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->status, FrameStatus::complete);
  EXPECT_TRUE(same_pixels(frame->counts, test_picture(exposure_index(*frame, 50), 161, 123, 14)));
}

TEST(GigePixels, AreUnswappedWhenTheCameraSendsTheHighByteFirst) {
  const auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source && source->set("GevSCPSBigEndian", "true"));
  ASSERT_TRUE(source->start());

  const auto frame = source->next(patience);

  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(source->info().settings.at("GevSCPSBigEndian"), "true");
  EXPECT_TRUE(same_pixels(frame->counts, test_picture(exposure_index(*frame, 50), 320, 240, 14)));
}

TEST(GigePixels, ShowTheNoiseReductionOnlyWhenItIsSwitchedOnOnPurpose) {
  const auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  ASSERT_EQ(source->info().settings.at("NoiseReduction"), "Off");
  ASSERT_TRUE(source->set("NoiseReduction", "On"));
  ASSERT_TRUE(source->start());

  const auto first = source->next(patience);
  const auto second = source->next(patience);

  ASSERT_TRUE(first && second);
  const auto a = test_picture(0, 320, 240, 14);
  const auto b = test_picture(1, 320, 240, 14);
  EXPECT_EQ(second->counts(0, 0), (a(0, 0) + b(0, 0) + 1) / 2);
  EXPECT_FALSE(same_pixels(second->counts, b));
}

class GigeRealRecording : public testing::TestWithParam<const char*> {};

TEST_P(GigeRealRecording, ArrivesByteForByte) {
  const auto path = std::filesystem::path(source_file("tests/golden/real")) / GetParam();
  const auto recording =
      path.extension() == ".seq" ? open_flir_seq(path) : open_raw_recording(path, {.width = 160, .height = 120});
  ASSERT_TRUE(recording) << recording.error().message;
  std::vector<cv::Mat1w> pictures;
  for (std::uint64_t k = 0; k < recording->frame_count; ++k) pictures.push_back(recording->read(k).value().counts);
  EmulatedGigeCameraConfig config;
  config.width = recording->info.width;
  config.height = recording->info.height;
  config.significant_bits = 16;
  config.frame_rate_hz = 100;
  const auto camera =
      EmulatedGigeCamera::start(config, [&pictures](std::uint64_t index) { return pictures[index % pictures.size()]; });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const auto frame = source->next(patience);

    ASSERT_TRUE(frame) << frame.error().message;
    ASSERT_EQ(frame->status, FrameStatus::complete);
    ASSERT_EQ(exposure_index(*frame, 100), k);
    ASSERT_TRUE(same_pixels(frame->counts, pictures[k])) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(All, GigeRealRecording,
                         testing::Values("lepton_a_160x120_u16le.raw", "lepton_b_160x120_u16le.raw", "flir_sc660.seq"),
                         [](const auto& test_case) {
                           std::string name = test_case.param;
                           return name.substr(0, name.find("_1")).substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace todbench
