// SPDX-License-Identifier: GPL-3.0-or-later
// Addresses of the bootstrap registers of every GigE Vision camera (GigE Vision 2.0, chapter 28).
#pragma once

#include <cstdint>

namespace todbench::gev {

inline constexpr std::uint32_t version = 0x0000;
inline constexpr std::uint32_t device_mode = 0x0004;
inline constexpr std::uint32_t mac_high = 0x0008;
inline constexpr std::uint32_t mac_low = 0x000C;
inline constexpr std::uint32_t supported_ip_configuration = 0x0010;
inline constexpr std::uint32_t current_ip_configuration = 0x0014;
inline constexpr std::uint32_t current_ip_address = 0x0024;
inline constexpr std::uint32_t current_subnet_mask = 0x0034;
inline constexpr std::uint32_t vendor_name = 0x0048;        ///< 32 bytes
inline constexpr std::uint32_t model_name = 0x0068;         ///< 32 bytes
inline constexpr std::uint32_t device_version = 0x0088;     ///< 32 bytes
inline constexpr std::uint32_t manufacturer_info = 0x00A8;  ///< 48 bytes
inline constexpr std::uint32_t serial_number = 0x00D8;      ///< 16 bytes
inline constexpr std::uint32_t first_url = 0x0200;          ///< 512 bytes
inline constexpr std::uint32_t second_url = 0x0400;         ///< 512 bytes
inline constexpr std::uint32_t network_interfaces = 0x0600;
inline constexpr std::uint32_t stream_channels = 0x0904;
inline constexpr std::uint32_t gvcp_capability = 0x0934;
inline constexpr std::uint32_t heartbeat_timeout = 0x0938;  ///< ms
inline constexpr std::uint32_t tick_frequency_low = 0x0940;
inline constexpr std::uint32_t control_privilege = 0x0A00;
inline constexpr std::uint32_t end_of_bootstrap = 0x0B00;
inline constexpr std::uint32_t stream_port = 0x0D00;
inline constexpr std::uint32_t stream_packet_size = 0x0D04;
inline constexpr std::uint32_t stream_packet_delay = 0x0D08;  ///< ticks
inline constexpr std::uint32_t stream_destination = 0x0D18;
inline constexpr std::uint32_t stream_source_port = 0x0D1C;
inline constexpr std::uint32_t end_of_stream_channel = 0x0D30;

/// Bits of control_privilege.
inline constexpr std::uint32_t exclusive_access = 1;
inline constexpr std::uint32_t control_access = 2;

/// Bits of stream_packet_size.
inline constexpr std::uint32_t fire_test_packet = 0x80000000;
inline constexpr std::uint32_t pixels_big_endian = 0x20000000;
inline constexpr std::uint32_t packet_size_mask = 0x0000FFFF;

/// Value of gvcp_capability: the device supports packet resend, WRITEMEM and several registers in one message.
inline constexpr std::uint32_t capabilities = 7;

/// Size of the answer to DISCOVERY: the first registers unchanged.
inline constexpr std::uint32_t discovery_bytes = 0x00F8;

}  // namespace todbench::gev
