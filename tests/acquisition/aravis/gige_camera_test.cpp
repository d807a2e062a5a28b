// SPDX-License-Identifier: GPL-3.0-or-later
// The Aravis back end and the emulated camera, over the real protocol on loopback.
#include <gmock/gmock.h>

#include <chrono>
#include <future>

#include "tests/support/gige_test_support.h"

namespace todbench {
namespace {

using namespace std::chrono_literals;
using namespace testing_support;
using testing::HasSubstr;

TEST(GigeDiscovery, FindsTheCameraByVendorAndSerial) {
  EmulatedGigeCameraConfig config;
  config.vendor = "Acme Infrared AB";
  config.model = "T-1";
  config.serial = "48/0123";
  const auto camera = start_camera(config);
  const auto backend = aravis_backend();

  const auto found = only_camera(*backend);

  EXPECT_EQ(found.id, "gige:Acme_Infrared_AB-48_0123");
  EXPECT_EQ(found.vendor, "Acme Infrared AB");
  EXPECT_EQ(found.model, "T-1");
  EXPECT_EQ(found.serial, "48/0123");
  EXPECT_EQ(found.address, "127.0.0.1");
}

TEST(GigeDiscovery, OpensByIdentityAndTellsTheSameIdentityWhenOpenedByAddress) {
  const auto camera = start_camera({});
  const auto backend = aravis_backend();

  auto by_identity = backend->open("gige:todbench-TB0001");

  ASSERT_TRUE(by_identity) << by_identity.error().message;
  const SourceInfo first = (*by_identity)->info();
  EXPECT_EQ(first.id, "gige:todbench-TB0001");
  by_identity->reset();
  const auto by_address = open_camera();
  ASSERT_TRUE(by_address);
  EXPECT_EQ(by_address->info().id, first.id);
  EXPECT_EQ(by_address->info().model, "Emulated LWIR");
  EXPECT_EQ(by_address->info().firmware, "1.0");
  EXPECT_EQ(by_address->info().transport, "GigE Vision");
}

TEST(GigeDiscovery, SaysWhichCamerasItSeesWhenTheIdentityIsAbsent) {
  const auto camera = start_camera({});

  const auto source = aravis_backend()->open("gige:todbench-OTHER");

  expect_not_found(source, "gige:todbench-TB0001");
}

TEST(GigeDiscovery, SaysNotFoundWhenNobodyAnswersAtTheAddress) {
  expect_not_found(aravis_backend()->open("gige:127.0.0.1"));
}

TEST(GigeDiscovery, RefusesAnIdOfAnotherScheme) {
  const auto source = aravis_backend()->open("u3v:todbench-TB0001");

  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().code, ErrorCode::invalid_input);
}

TEST(GigeDiscovery, TellsASecondClientThatTheCameraIsBusy) {
  const auto camera = start_camera({});
  const auto first = open_camera();
  ASSERT_TRUE(first);

  const auto second = aravis_backend()->open("gige:127.0.0.1");

  expect_not_found(second, "busy");
}

TEST(UsbDiscovery, ListsWithoutAnyCameraAndSaysNotFoundForOne) {
  const auto backend = aravis_backend({.transport = AravisTransport::usb3_vision});

  EXPECT_EQ(backend->scheme(), "u3v");
  EXPECT_TRUE(backend->list());
  EXPECT_EQ(backend->open("u3v:todbench-NONE").error().code, ErrorCode::not_found);
}

TEST(EmulatedCamera, RefusesAnAddressThatAnotherCameraHas) {
  EmulatedGigeCameraConfig config;
  const auto first = start_camera(config);
  config.serial = "TB0002";

  const auto second = EmulatedGigeCamera::start(config, test_exposures(config));

  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::not_found);
  EXPECT_THAT(second.error().message, HasSubstr("busy"));
}

TEST(EmulatedCamera, RefusesAnInterfaceThatDoesNotExist) {
  EmulatedGigeCameraConfig config;
  config.interface_address = "10.255.255.1";

  const auto camera = EmulatedGigeCamera::start(config, test_exposures(config));

  ASSERT_FALSE(camera);
  EXPECT_EQ(camera.error().code, ErrorCode::not_found);
}

TEST(EmulatedCamera, CountsExposuresOfTheWrongSizeInsteadOfSendingThem) {
  const EmulatedGigeCameraConfig config;
  const auto camera = EmulatedGigeCamera::start(config, [](std::uint64_t) { return cv::Mat1w(2, 2, ushort{9}); });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());

  const auto frame = source->next(patience);

  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(cv::countNonZero(frame->counts), 0);
  EXPECT_GE((*camera)->failed_exposures(), 1U);
}

TEST(GigeScale, IsReadBackFromTheCameraWithItsOffset) {
  EmulatedGigeCameraConfig config;
  config.kelvin_per_count = 0.02;
  config.offset_k = 250;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source);

  const auto kelvin = source->info().scale.kelvin(2500);

  ASSERT_TRUE(kelvin);
  EXPECT_DOUBLE_EQ(*kelvin, 300);
}

TEST(GigeScale, FollowsTheFormatSoThatATemperatureReadsTheSameWithinItsStep) {
  EmulatedGigeCameraConfig config;
  config.significant_bits = 16;
  const auto camera =
      EmulatedGigeCamera::start(config, [](std::uint64_t) { return cv::Mat1w(240, 320, ushort{30'012}); });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = open_camera();
  ASSERT_TRUE(source);
  // 30012 counts of 0.01 K are 300.12 K. Half a step: 5 mK, 50 mK; the radiometric formula has 51 counts per kelvin
  // there (dS/dT = R B e^(B/T) / (T^2 (e^(B/T) - F)^2)), half a step is 10 mK.
  const std::vector<std::pair<std::string, double>> half_steps{
      {"TemperatureLinear10mK", 0.005}, {"TemperatureLinear100mK", 0.05}, {"Radiometric", 0.0101}};

  for (const auto& [format, half_step] : half_steps) {
    ASSERT_TRUE(source->set("IRFormat", format));
    ASSERT_TRUE(source->start());
    const auto frame = source->next(patience);
    source->stop();

    ASSERT_TRUE(frame) << frame.error().message;
    const auto kelvin = frame->scale->kelvin(frame->counts(120, 160));
    ASSERT_TRUE(kelvin) << format;
    EXPECT_NEAR(*kelvin, 300.12, half_step * 1.0001) << format;
  }
}

TEST(GigeFeatures, AreReadAndWrittenAsTextWhateverTheirType) {
  const auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);

  ASSERT_TRUE(source->set("NUCIntervalFrames", "1234"));
  ASSERT_TRUE(source->set("AcquisitionFrameRate", "25"));
  ASSERT_TRUE(source->set("NUCMode", "Automatic"));
  ASSERT_TRUE(source->set("GevSCPSBigEndian", "true"));
  camera->set_device_temperature_c(-12.25);

  EXPECT_EQ(source->get("NUCIntervalFrames").value(), "1234");
  EXPECT_EQ(source->get("AcquisitionFrameRate").value(), "25");
  EXPECT_EQ(source->get("NUCMode").value(), "Automatic");
  EXPECT_EQ(source->get("GevSCPSBigEndian").value(), "true");
  EXPECT_EQ(source->get("DeviceSerialNumber").value(), "TB0001");
  EXPECT_EQ(source->get("DeviceTemperature").value(), "-12.25");
  EXPECT_EQ(source->info().frame_rate_hz, 25);
  EXPECT_EQ(source->info().settings.at("NUCMode"), "Automatic");
}

TEST(GigeFeatures, RefuseWhatTheCameraWouldNotUnderstandAndSayWhatItWould) {
  const auto camera = start_camera({});
  const auto source = open_camera();
  ASSERT_TRUE(source);
  const std::vector<std::tuple<std::string, std::string, std::string>> refused{
      {"NoSuchFeature", "1", "no feature"},          {"NUCIntervalFrames", "0", "1 ... 1000000"},
      {"NUCIntervalFrames", "many", "whole number"}, {"AcquisitionFrameRate", "5000", "0.1 ... 1000"},
      {"NUCMode", "Sometimes", "Manual, Automatic"}, {"GevSCPSBigEndian", "perhaps", "true or false"},
      {"DeviceSerialNumber", "X", "read-only"},      {"Width", "100", "read-only"}};

  for (const auto& [feature, value, reason] : refused) {
    const auto done = source->set(feature, value);

    ASSERT_FALSE(done) << feature;
    EXPECT_EQ(done.error().code, ErrorCode::invalid_input) << feature;
    EXPECT_THAT(done.error().message, HasSubstr(reason));
  }
  EXPECT_EQ(source->get("NUCAction").error().code, ErrorCode::invalid_input);
}

TEST(GigeNonuniformity, TheCommandReachesTheCameraAlsoWhileItStands) {
  std::promise<void> corrected;
  const EmulatedGigeCameraConfig config;
  const auto camera =
      EmulatedGigeCamera::start(config, test_exposures(config), [&corrected] { corrected.set_value(); });
  ASSERT_TRUE(camera) << camera.error().message;
  const auto source = open_camera();
  ASSERT_TRUE(source);

  const auto commanded = source->correct_nonuniformity();

  ASSERT_TRUE(commanded) << commanded.error().message;
  ASSERT_EQ(corrected.get_future().wait_for(patience), std::future_status::ready);
  EXPECT_EQ((*camera)->nonuniformity_corrections(), 1U);
}

TEST(GigeNonuniformity, FreezesThePictureForTheStatedFramesAndThenContinuesInStep) {
  EmulatedGigeCameraConfig config;
  config.nuc_freeze_frames = 5;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->start());
  const auto first = source->next(patience);
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(source->correct_nonuniformity());

  int frozen = 0;
  bool thawed = false;
  cv::Mat1w previous = first->counts;
  for (int k = 0; k < 100 && !thawed; ++k) {
    const auto frame = source->next(patience);
    ASSERT_TRUE(frame) << frame.error().message;
    const bool repeated = same_pixels(frame->counts, previous);
    if (repeated) ++frozen;
    thawed = frozen > 0 && !repeated;
    if (thawed) {
      EXPECT_TRUE(same_pixels(frame->counts, test_picture(exposure_index(*frame, 50), 320, 240, 14)));
    }
    previous = frame->counts;
  }

  EXPECT_TRUE(thawed);
  EXPECT_EQ(frozen, 5);
}

TEST(GigeNonuniformity, HappensByItselfInAutomaticMode) {
  EmulatedGigeCameraConfig config;
  config.frame_rate_hz = 100;
  const auto camera = start_camera(config);
  const auto source = open_camera();
  ASSERT_TRUE(source && source->set("NUCMode", "Automatic") && source->set("NUCIntervalFrames", "10"));
  ASSERT_TRUE(source->start());

  for (int k = 0; k < 35; ++k) ASSERT_TRUE(source->next(patience));

  // Before exposures 10, 20 and 30; the camera may be ahead of the client.
  EXPECT_GE(camera->nonuniformity_corrections(), 3U);
}

}  // namespace
}  // namespace todbench
