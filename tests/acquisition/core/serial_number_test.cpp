// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/core/serial_number.h"

#include <gtest/gtest.h>

namespace todbench {
namespace {

TEST(SerialNumber, OfManyUnitsIsAPlaceholder) {
  for (const char* serial : {"", "0", "000000000000", "FFFFFFFF", "0123456789", "0123456789ABCDEF", "123456",
                             "12345678", "200901010001", "20200101", "202001010001", "01.00.00", "SN0001", "0x0001",
                             "default", "Default string", "To be filled by O.E.M.", "N/A", "1234567890"}) {
    EXPECT_TRUE(is_placeholder_serial(serial)) << serial;
  }
}

TEST(SerialNumber, OfOneUnitIsNone) {
  for (const char* serial : {"48000123", "TB0001", "A1", "B2", "8008001c", "7", "71301234", "200901021734",
                             "20090101734", "E2301500", "00012345", "S-1002", "1", "62"}) {
    EXPECT_FALSE(is_placeholder_serial(serial)) << serial;
  }
  EXPECT_EQ(placeholder_serial_warning("48000123"), "");
  EXPECT_NE(placeholder_serial_warning("200901010001"), "");
}

}  // namespace
}  // namespace todbench
