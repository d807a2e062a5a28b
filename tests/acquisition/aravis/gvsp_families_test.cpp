// SPDX-License-Identifier: GPL-3.0-or-later
// Set-up of real families behind the GigE Vision camera on plain sockets.
#include <gmock/gmock.h>

#include <chrono>

#include "acquisition/core/integrity_gate.h"
#include "tests/acquisition/aravis/gvsp_passages.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

TEST(Ax5, IsSetUpForMeasuring) {
  const auto camera = start_gvsp_camera({});

  const auto source = open_camera();

  ASSERT_TRUE(source);
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.pixel_format, "Mono14");
  EXPECT_EQ(info.significant_bits, 14);
  EXPECT_EQ(info.frame_rate_hz, 50);
  ASSERT_TRUE(info.scale.calibrated());
  EXPECT_NEAR(*info.scale.kelvin(7500), 300, 1e-9);  // 0.04 K per count
  EXPECT_EQ(info.settings.at("CameraFamily"), "FLIR Ax5");
  EXPECT_EQ(info.settings.at("CMOSBitDepth"), "bit14bit");
  EXPECT_EQ(info.settings.at("DigitalOutput"), "bit14bit");
  EXPECT_EQ(info.settings.at("TemperatureLinearMode"), "On");
  EXPECT_EQ(info.settings.at("TemperatureLinearResolution"), "High");
  EXPECT_EQ(info.settings.at("SensorDDEMode"), "Off");
  EXPECT_THAT(info.warnings, testing::Not(testing::Contains(HasSubstr("byte order"))));
  EXPECT_EQ(*source->get("IRTestPattern"), "Off");
}

TEST(Ax5, TellsWhatItTakesTheSceneFor) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().warnings, testing::Not(testing::Contains(HasSubstr("computes its temperatures"))));
  for (const char* feature : {"ObjectEmissivity", "WindowTransmission", "AtmosphericTransmission"}) {
    ASSERT_TRUE(source->info().settings.contains(feature)) << feature;
    EXPECT_NEAR(std::stod(source->info().settings.at(feature)), 1, 1e-6) << feature;
  }
  for (const char* feature : {"ReflectedTemperature", "WindowTemperature", "AtmosphericTemperature"}) {
    ASSERT_TRUE(source->info().settings.contains(feature)) << feature;
    EXPECT_NEAR(std::stod(source->info().settings.at(feature)), 293, 1e-6) << feature;
  }

  ASSERT_TRUE(source->set("WindowTransmission", "0.8"));
  ASSERT_TRUE(source->set("WindowTemperature", "300"));

  // Steps of 1/8192.
  EXPECT_NEAR(std::stod(source->info().settings.at("WindowTransmission")), 0.8, 1.3e-4);
  EXPECT_NEAR(std::stod(source->info().settings.at("WindowTemperature")), 300, 0.01);
  EXPECT_THAT(source->info().warnings, testing::Contains(HasSubstr("with WindowTransmission = 0.79")));
  ASSERT_TRUE(source->set("WindowTransmission", "1"));
  EXPECT_THAT(source->info().warnings, testing::Not(testing::Contains(HasSubstr("computes its temperatures"))));
}

TEST(Ax5, WhoseBytesArriveSwappedIsFoundOutByItsTestRampAndReadRight) {
  const auto config = quick();
  const auto camera = start_gvsp_camera(config);
  camera->set_faults({.swapped_bytes = 1});

  const auto source = open_started();

  ASSERT_TRUE(source);
  EXPECT_THAT(source->info().warnings, testing::Contains(HasSubstr("arrive swapped")));
  EXPECT_EQ(receive(*source, config, 10).false_pixels, 0);
}

TEST(Ax5, CorrectsOnlyWhenCommandedOnceTheFirstCommandWasGiven) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  ASSERT_EQ(*source->get("NUCMode"), "Automatic");

  const auto done = source->correct_nonuniformity();

  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(*source->get("NUCMode"), "Manual");
  EXPECT_EQ(camera->counts().corrections, 1U);
  EXPECT_EQ(source->info().settings.at("NUCMode"), "Manual");
}

TEST(Ax5, RepeatsItsLastPictureDuringACorrection) {
  auto config = quick();
  config.nuc_freeze_frames = 10;
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);
  auto last = source->next(patience);
  ASSERT_TRUE(last && source->correct_nonuniformity());

  int repeats = 0;
  for (int k = 0; k < 60; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame);
    if (same_pixels(frame->counts, last->counts)) ++repeats;
    last = frame;
  }

  EXPECT_EQ(repeats, 10);
}

TEST(Ax5, RefusesToChangeItsFormatWhileItStreams) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_started();
  ASSERT_TRUE(source);

  EXPECT_FALSE(source->set("PixelFormat", "Mono8"));

  source->stop();
  EXPECT_TRUE(source->set("CMOSBitDepth", "bit14bit"));
}

TEST(Ax5, TakesItsRateFromTheVideoStandard) {
  const auto camera = start_gvsp_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("SensorVideoStandard", "NTSC30HZ"));

  EXPECT_EQ(source->info().frame_rate_hz, 30);
}

TEST(Families, ALegacyScienceCameraSendsTheHighByteFirstAndIsReadRight) {
  const auto config = quick(CameraModel::legacy_science);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.complete, 20);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST(Families, AnASeriesCameraDeliversHundredthsOfAKelvinWithoutNoiseReduction) {
  const auto config = quick(CameraModel::a_series);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_NEAR(*source->info().scale.kelvin(30000), 300, 1e-9);
  EXPECT_EQ(source->info().settings.at("NoiseReduction"), "Off");
  ASSERT_TRUE(source->correct_nonuniformity());
  EXPECT_EQ(*source->get("NUCMode"), "Off");
}

TEST(Families, ACameraNobodyKnowsWorksInCountsAndItsShutterIsFoundByName) {
  const auto config = quick(CameraModel::unlisted);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  const Received got = receive(*source, config, 20);

  EXPECT_EQ(got.false_pixels, 0);
  EXPECT_FALSE(source->info().scale.calibrated());
  EXPECT_EQ(source->info().settings.at("CameraFamily"), "unlisted");
  ASSERT_TRUE(source->correct_nonuniformity());
  EXPECT_EQ(camera->counts().corrections, 1U);
  EXPECT_EQ(*source->get("FlagMode"), "Manual");
}

TEST(Families, ACameraNobodyKnowsTakesAScaleThatWasMeasuredOnTheBench) {
  const auto config = quick(CameraModel::unlisted);
  const auto camera = start_gvsp_camera(config);
  const auto source = open_started();
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("TemperatureLinearOffset", "250"));
  EXPECT_FALSE(source->info().scale.calibrated());
  ASSERT_TRUE(source->set("TemperatureLinearScale", "0.01"));

  EXPECT_EQ(*source->get("TemperatureLinearScale"), "0.01");
  EXPECT_EQ(source->info().settings.at("TemperatureLinearOffset"), "250");
  EXPECT_DOUBLE_EQ(*source->info().scale.kelvin(5000), 300);
  EXPECT_EQ(source->set("TemperatureLinearScale", "0").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(source->set("TemperatureLinearOffset", "warm").error().code, ErrorCode::invalid_input);
}

TEST(GvspSize, ThatIsNotTheOneStatedIsNamedAndTakenWhereThePlanStatesIt) {
  GvspCameraConfig config = quick(CameraModel::a_series);
  config.rows_not_sent = 6;  // an A325 counts 246 rows and sends 240
  const auto camera = start_gvsp_camera(config);
  {
    const auto source = open_started();
    ASSERT_TRUE(source);
    Result<Frame> frame;
    for (int k = 0; k < 40 && (frame = source->next(patience)); ++k) EXPECT_EQ(frame->status, FrameStatus::wrong_size);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().code, ErrorCode::integrity);
    EXPECT_THAT(frame.error().message, HasSubstr("frames of 160x134 but sends frames of 160x128"));
    EXPECT_THAT(frame.error().message, HasSubstr("frame_size = \"160x128\""));
  }
  const auto source = open_camera();
  ASSERT_TRUE(source);
  EXPECT_FALSE(source->set("FrameSize", "160 x 128"));

  ASSERT_TRUE(source->set("FrameSize", "160x128") && source->start());

  EXPECT_EQ(source->info().height, 128);
  const Received got = receive(*source, config, 20);
  EXPECT_EQ(got.complete, 20);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST(GvspChunks, OfGigEVision1AreSwitchedOffWhenTheCameraIsOpened) {
  GvspCameraConfig config = quick();
  config.chunks_at_power_up = true;
  config.chunk_payload_type = 4;
  const auto camera = start_gvsp_camera(config);

  const auto source = open_started();

  ASSERT_TRUE(source);
  EXPECT_EQ(*source->get("ChunkModeActive"), "Off");
  const Received got = receive(*source, config, 20);
  EXPECT_EQ(got.complete, 20);
  EXPECT_EQ(got.false_pixels, 0);
}

TEST(GvspCorrection, IsTheCommandThatThePlanNames) {
  const auto camera = start_gvsp_camera(quick(CameraModel::unlisted));
  const auto source = open_camera();
  ASSERT_TRUE(source);

  const auto refused = source->set("NonuniformityCommand", "Calibrate");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("FlagCalibrate"));
  ASSERT_TRUE(source->set("NonuniformityCommand", "FlagCalibrate"));
  ASSERT_TRUE(source->correct_nonuniformity());

  EXPECT_EQ(camera->counts().corrections, 1u);
}

}  // namespace
}  // namespace todbench
