// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/camera_id.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

TEST(CameraId, OfAnIdentityHasLettersDigitsDotsAndUnderscoresOnly) {
  EXPECT_EQ(camera_id(camera_scheme::gige, {"Acme Infrared AB", "48/0123"}), "gige:Acme_Infrared_AB-48_0123");
  EXPECT_EQ(camera_id(camera_scheme::v4l2, {"GroupGets", "PureThermal (fw:v1.3.0)", "8008001c"}),
            "v4l2:GroupGets-PureThermal__fw_v1.3.0_-8008001c");
}

TEST(CameraId, OfAnIdentityWithoutAVendorStillSaysWhichPartIsWhich) {
  EXPECT_EQ(camera_id(camera_scheme::gige, {"", "7"}), "gige:-7");
}

TEST(CameraId, OfANameKeepsItAsItIs) {
  EXPECT_EQ(camera_id(camera_scheme::file, "/a b/c?rate=2"), "file:/a b/c?rate=2");
}

TEST(CameraId, IsTakenApartByItsSchemeOnly) {
  EXPECT_EQ(camera_name("file:/a:b", camera_scheme::file), "/a:b");
  EXPECT_EQ(camera_name("sim:", camera_scheme::sim), "");
  EXPECT_FALSE(camera_name("simulated:x", camera_scheme::sim));
  EXPECT_FALSE(camera_name("sim", camera_scheme::sim));
  EXPECT_FALSE(has_scheme("gige:127.0.0.1", camera_scheme::usb));
}

}  // namespace
}  // namespace todbench
