// SPDX-License-Identifier: GPL-3.0-or-later
// Messages of the GigE Vision control protocol (GVCP) as values. Source: GigE Vision 2.0, chapters 14 to 18.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "sim_devices/lab/gige/big_endian.h"

namespace todbench {

/// Command of a request.
enum class GvcpCommand : std::uint16_t {
  discovery = 0x0002,
  force_ip = 0x0004,
  packet_resend = 0x0040,
  read_register = 0x0080,
  write_register = 0x0082,
  read_memory = 0x0084,
  write_memory = 0x0086,
};

/// Status of an acknowledge.
enum class GvcpStatus : std::uint16_t {
  success = 0x0000,
  not_implemented = 0x8001,
  invalid_parameter = 0x8002,
  invalid_address = 0x8003,
  write_protect = 0x8004,
  bad_alignment = 0x8005,
  access_denied = 0x8006,
  busy = 0x8007,
};

/// Request as received; `command` may be a number outside GvcpCommand.
struct GvcpRequest {
  std::uint16_t command = 0;
  std::uint16_t id = 0;
  bool wants_acknowledge = false;         ///< the client requests an acknowledge
  std::span<const std::uint8_t> payload;  ///< view into the datagram
};

/// Longest payload of a message: a READMEM of 536 bytes with its address.
inline constexpr std::size_t gvcp_most_payload_bytes = 540;

/// Parses a request. Empty if the datagram does not begin with the key 0x42, has the id 0, or has a length other than
/// the stated length. A camera does not respond to such a datagram.
[[nodiscard]] std::optional<GvcpRequest> parse_gvcp_request(std::span<const std::uint8_t> datagram);

/// Returns the acknowledge of a request. Its command number is the number of the request plus one.
[[nodiscard]] Bytes gvcp_acknowledge(const GvcpRequest& request, GvcpStatus status,
                                     std::span<const std::uint8_t> payload);

/// Contents of a PACKETRESEND.
struct ResendRequest {
  std::uint16_t block_id = 0;
  std::uint32_t first_packet = 0, last_packet = 0;  ///< 24 bits each, inclusive
};

/// Parses the payload of a PACKETRESEND. Empty if the payload is too short or the range of packets is reversed.
[[nodiscard]] std::optional<ResendRequest> parse_resend_request(std::span<const std::uint8_t> payload);

}  // namespace todbench
