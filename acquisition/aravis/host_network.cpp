// SPDX-License-Identifier: GPL-3.0-or-later
#include "acquisition/aravis/host_network.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

namespace todbench {
namespace {

std::optional<std::uint32_t> address_of(const std::string& ipv4) {
  in_addr address{};
  if (inet_pton(AF_INET, ipv4.c_str(), &address) != 1) return std::nullopt;
  return ntohl(address.s_addr);
}

std::uint32_t value_of(const sockaddr* address) {
  return ntohl(reinterpret_cast<const sockaddr_in*>(address)->sin_addr.s_addr);
}

std::string dotted(std::uint32_t address) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) {
    text += (text.empty() ? "" : ".") + std::to_string(address >> static_cast<unsigned>(shift) & 0xFFU);
  }
  return text;
}

int mtu_of(const std::string& interface) {
  std::ifstream file("/sys/class/net/" + interface + "/mtu");
  int mtu = 0;
  return file >> mtu ? mtu : 0;
}

const HostAddress* network_of(std::uint32_t camera, const std::vector<HostAddress>& hosts) {
  const auto holds = [&](const HostAddress& host) { return (host.address & host.mask) == (camera & host.mask); };
  const auto found = std::find_if(hosts.begin(), hosts.end(), holds);
  return found == hosts.end() ? nullptr : &*found;
}

}  // namespace

std::vector<HostAddress> host_addresses() {
  std::vector<HostAddress> hosts;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return hosts;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owned(list, freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const bool usable = entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET &&
                        entry->ifa_netmask != nullptr && (entry->ifa_flags & IFF_UP) != 0;
    if (!usable) continue;
    hosts.push_back({.interface = entry->ifa_name,
                     .address = value_of(entry->ifa_addr),
                     .mask = value_of(entry->ifa_netmask),
                     .mtu_bytes = mtu_of(entry->ifa_name)});
  }
  return hosts;
}

std::string wrong_network(const std::string& ipv4, const std::vector<HostAddress>& hosts) {
  const auto camera = address_of(ipv4);
  if (!camera || network_of(*camera, hosts) != nullptr) return {};
  std::string own;
  for (const HostAddress& host : hosts) {
    if (host.address >> 24U == 127) continue;
    own += (own.empty() ? "" : ", ") + dotted(host.address) + " (" + host.interface + ")";
  }
  return "The camera's address " + ipv4 + " is in none of the networks of this computer" +
         (own.empty() ? "" : "; the computer's addresses: " + own) +
         ". Give the camera or an interface an address in the same network.";
}

std::string packets_too_large(const std::string& ipv4, int packet_bytes, const std::vector<HostAddress>& hosts) {
  const auto camera = address_of(ipv4);
  const HostAddress* host = camera ? network_of(*camera, hosts) : nullptr;
  if (host == nullptr || host->mtu_bytes <= 0 || packet_bytes <= host->mtu_bytes) return {};
  return "The camera sends packets of " + std::to_string(packet_bytes) + " bytes, but the interface " +
         host->interface + " passes at most " + std::to_string(host->mtu_bytes) +
         ". No frame will arrive. Set GevSCPSPacketSize in [camera.settings], or raise the MTU with: ip link set " +
         host->interface + " mtu " + std::to_string(packet_bytes);
}

}  // namespace todbench
