// SPDX-License-Identifier: GPL-3.0-or-later
// IPv4 networks of this computer, to check the address and packet size of a camera.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace todbench {

/// An IPv4 address of this computer.
struct HostAddress {
  std::string interface;                ///< "eth0"
  std::uint32_t address = 0, mask = 0;  ///< host byte order
  int mtu_bytes = 0;                    ///< 0: unknown
};

/// Returns the addresses of the interfaces that are up.
[[nodiscard]] std::vector<HostAddress> host_addresses();

/// Returns a warning if none of these networks contains the address `ipv4` of the camera. The camera then answers
/// broadcasts, but no other packets reach it. Empty if a network contains the address or `ipv4` is not an address.
[[nodiscard]] std::string wrong_network(const std::string& ipv4, const std::vector<HostAddress>& hosts);

/// Returns a warning if packets of this size, IP and UDP headers included, exceed the MTU of the camera's interface.
/// Empty if they fit or the interface is unknown.
[[nodiscard]] std::string packets_too_large(const std::string& ipv4, int packet_bytes,
                                            const std::vector<HostAddress>& hosts);

}  // namespace todbench
