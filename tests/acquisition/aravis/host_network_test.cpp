// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/host_network.h"

#include <gmock/gmock.h>

namespace todbench {
namespace {

using ::testing::HasSubstr;

const std::vector<HostAddress> hosts{{"lo", 0x7F000001, 0xFF000000, 65536}, {"eth1", 0xC0A80105, 0xFFFFFF00, 1500}};

TEST(HostNetwork, NamesACameraInAnotherNetwork) {
  EXPECT_THAT(wrong_network("169.254.3.7", hosts), HasSubstr("169.254.3.7 is in none of the networks"));
  EXPECT_THAT(wrong_network("169.254.3.7", hosts), HasSubstr("192.168.1.5 (eth1)"));
  EXPECT_THAT(wrong_network("192.168.2.10", hosts), HasSubstr("none of the networks"));
  EXPECT_EQ(wrong_network("192.168.1.10", hosts), "");
  EXPECT_EQ(wrong_network("127.0.0.2", hosts), "");
  EXPECT_EQ(wrong_network("", hosts), "");
}

TEST(HostNetwork, NamesPacketsThatTheInterfaceDoesNotPass) {
  EXPECT_THAT(packets_too_large("192.168.1.10", 8000, hosts), HasSubstr("eth1 passes at most 1500"));
  EXPECT_EQ(packets_too_large("192.168.1.10", 1500, hosts), "");
  EXPECT_EQ(packets_too_large("127.0.0.1", 8000, hosts), "");
  EXPECT_EQ(packets_too_large("10.0.0.1", 8000, hosts), "");
}

TEST(HostNetwork, OfThisHostHoldsItsLoopback) {
  EXPECT_EQ(wrong_network("127.0.0.1", host_addresses()), "");
}

}  // namespace
}  // namespace todbench
