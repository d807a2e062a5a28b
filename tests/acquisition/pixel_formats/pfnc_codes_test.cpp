// SPDX-License-Identifier: GPL-3.0-or-later
// The codes of the table against those that Aravis defines.
#include <arv.h>
#include <gtest/gtest.h>

#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {
namespace {

TEST(PfncCodes, AreThoseOfAravis) {
  EXPECT_EQ(pfnc_code(PixelFormat::mono8), ARV_PIXEL_FORMAT_MONO_8);
  EXPECT_EQ(pfnc_code(PixelFormat::mono10), ARV_PIXEL_FORMAT_MONO_10);
  EXPECT_EQ(pfnc_code(PixelFormat::mono12), ARV_PIXEL_FORMAT_MONO_12);
  EXPECT_EQ(pfnc_code(PixelFormat::mono14), ARV_PIXEL_FORMAT_MONO_14);
  EXPECT_EQ(pfnc_code(PixelFormat::mono16), ARV_PIXEL_FORMAT_MONO_16);
  EXPECT_EQ(pfnc_code(PixelFormat::yuyv), ARV_PIXEL_FORMAT_YUV_422_YUYV_PACKED);
  EXPECT_EQ(pfnc_code(PixelFormat::mono10p), 0x010A0046U);  // PFNC 2.4; Aravis 0.8 has no name for it
  EXPECT_EQ(pfnc_code(PixelFormat::mono12p), 0x010C0047U);
  EXPECT_EQ(pfnc_code(PixelFormat::mono10_packed), ARV_PIXEL_FORMAT_MONO_10_PACKED);
  EXPECT_EQ(pfnc_code(PixelFormat::mono12_packed), ARV_PIXEL_FORMAT_MONO_12_PACKED);
  EXPECT_EQ(std::size(pixel_format_table), 10U);  // a format that is added has a line above
}

}  // namespace
}  // namespace todbench
