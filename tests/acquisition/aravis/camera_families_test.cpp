// SPDX-License-Identifier: GPL-3.0-or-later
// What is known of camera families, the test ramp, and the limits on what a camera may state: pure functions.
#include <gmock/gmock.h>

#include "acquisition/aravis/camera_families.h"
#include "acquisition/aravis/object_parameters.h"
#include "acquisition/aravis/test_ramp.h"

namespace todbench {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool no_features(const std::string&) {
  return false;
}

TEST(CameraFamilies, AreToldByVendorAndModel) {
  EXPECT_EQ(camera_family("FLIR", "AX5", no_features).name, "FLIR Ax5");
  EXPECT_EQ(camera_family("FLIR Systems", "FLIR A35", no_features).name, "FLIR Ax5");
  EXPECT_EQ(camera_family("FLIR Systems AB", "A655sc", no_features).name, "FLIR A3xx/A6xx");
  EXPECT_EQ(camera_family("FLIR Systems AB", "A320G", no_features).name, "FLIR science, high byte first");
  EXPECT_EQ(camera_family("Teledyne FLIR", "A70", no_features).name, "FLIR A50 ... A700");
  EXPECT_EQ(camera_family("FLIR", "A500", no_features).name, "FLIR A50 ... A700");
  EXPECT_EQ(camera_family("Xenics", "Gobi-640-GigE", no_features).name, "unlisted");
}

TEST(CameraFamilies, AreToldByFeaturesWhereTheNameSaysNothing) {
  const auto ir_format = [](const std::string& feature) { return feature == "IRFormat"; };

  EXPECT_EQ(camera_family("Somebody", "X1", ir_format).linear.front().kelvin_per_count, 0.01);
}

TEST(CameraFamilies, OfAFlirAx5HaveTheFinestStepFirstAndATestRamp) {
  const CameraFamily family = camera_family("FLIR", "A65", no_features);

  EXPECT_EQ(family.linear.front().kelvin_per_count, 0.04);
  EXPECT_EQ(family.test_pattern, "IRTestPattern");
  EXPECT_THAT(family.nuc_commanded, ElementsAre("Manual"));
}

TEST(CorrectionCommands, AreFoundByNameAndThePlainOneComesFirst) {
  EXPECT_THAT(correction_commands({"NUCActionLong", "AcquisitionStart", "NUCAction"}),
              ElementsAre("NUCAction", "NUCActionLong"));
  EXPECT_THAT(correction_commands({"FlagCalibrate", "UserSetLoad"}), ElementsAre("FlagCalibrate"));
  EXPECT_THAT(correction_commands({"OffsetCorrection", "ShutterCalibration", "DoFFC"}),
              ElementsAre("DoFFC", "ShutterCalibration", "OffsetCorrection"));
}

TEST(CorrectionCommands, AreNeverOnesThatLoadStoreOrMoveTheShutter) {
  EXPECT_THAT(correction_commands({"NUCLoad", "FactoryNUCReset", "ShutterClose", "ShutterOpen", "SaveFFC", "OffsetX",
                                   "CalibrationStore", "LensCalibration"}),
              IsEmpty());
}

TEST(CorrectionModes, AreFoundByNameAndTheCommandedEntryIsManualOrOff) {
  EXPECT_THAT(correction_modes({"FlagMode", "PixelFormat", "AutoShutter", "NUCMode"}),
              ElementsAre("FlagMode", "AutoShutter", "NUCMode"));
  EXPECT_EQ(commanded_entry({"Automatic", "Manual", "Off"}), "Manual");
  EXPECT_EQ(commanded_entry({"On", "Off"}), "Off");
  EXPECT_EQ(commanded_entry({"Automatic", "External", "Command"}), "Command");
  EXPECT_EQ(commanded_entry({"Automatic", "Periodic"}), "");
}

TEST(ObjectParameters, ThatAreNotNeutralAreTold) {
  const auto notes = [](const std::map<std::string, std::string>& settings) {
    const auto all = object_parameter_notes(settings);
    return all.empty() ? std::string() : all.front();
  };
  EXPECT_EQ(notes({}), "");
  EXPECT_EQ(notes({{"ObjectEmissivity", "0.9999999"}, {"WindowTransmission", "1"}, {"WindowTemperature", "350"}}), "");
  EXPECT_EQ(notes({{"EstimatedTransmission", "1"}, {"ObjectDistance", "100"}}), "");
  EXPECT_THAT(notes({{"ObjectEmissivity", "0.95"}, {"WindowTransmission", "0.8"}}),
              HasSubstr("ObjectEmissivity = 0.95, WindowTransmission = 0.8."));
  EXPECT_THAT(notes({{"WindowReflection", "0.1"}}), HasSubstr("WindowReflection"));
  EXPECT_THAT(notes({{"EstimatedTransmission", "0"}, {"ObjectDistance", "2"}}), HasSubstr("ObjectDistance = 2"));
  EXPECT_THAT(notes({{"EstimatedTransmission", "0.9"}}), HasSubstr("EstimatedTransmission = 0.9"));
  EXPECT_THAT(notes({{"ExtOpticsTransmission", "nan"}}), HasSubstr("ExtOpticsTransmission"));
}

cv::Mat1w ramp(int width, int step) {
  cv::Mat1w picture(4, width);
  for (int x = 0; x < width; ++x) picture.col(x).setTo(x * step);
  return picture;
}

cv::Mat1w swapped(const cv::Mat1w& picture) {
  cv::Mat1w out = picture.clone();
  for (auto& count : out) count = static_cast<ushort>(count << 8 | count >> 8);
  return out;
}

TEST(TestRamp, IsReadInBothOrders) {
  for (const int step : {1, 25, 100}) {
    EXPECT_EQ(judge_test_ramp(ramp(640, step)), RampVerdict::in_order) << step;
    EXPECT_EQ(judge_test_ramp(swapped(ramp(640, step))), RampVerdict::swapped) << step;
  }
}

TEST(TestRamp, IsNotSeenInAFlatOrNoisyOrTooSmallPicture) {
  cv::Mat1w noise(8, 64);
  cv::RNG random(1);
  random.fill(noise, cv::RNG::UNIFORM, 0, 16384);

  EXPECT_EQ(judge_test_ramp(cv::Mat1w(8, 64, ushort{7000})), RampVerdict::no_ramp);
  EXPECT_EQ(judge_test_ramp(noise), RampVerdict::no_ramp);
  EXPECT_EQ(judge_test_ramp(ramp(8, 1)), RampVerdict::no_ramp);
}

}  // namespace
}  // namespace todbench
