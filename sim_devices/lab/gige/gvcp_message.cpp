// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvcp_message.h"

namespace todbench {
namespace {

constexpr std::uint8_t gvcp_key = 0x42;
constexpr std::uint8_t flag_acknowledge = 0x01;
constexpr std::size_t header_bytes = 8;
constexpr std::uint32_t packet_id_mask = 0x00FFFFFF;

}  // namespace

std::optional<GvcpRequest> parse_gvcp_request(std::span<const std::uint8_t> datagram) {
  if (datagram.size() < header_bytes || datagram[0] != gvcp_key) return std::nullopt;
  const auto length = big_endian_at(datagram, 4, 2);
  if (length != datagram.size() - header_bytes || length > gvcp_most_payload_bytes) return std::nullopt;
  GvcpRequest request;
  request.wants_acknowledge = (datagram[1] & flag_acknowledge) != 0;
  request.command = static_cast<std::uint16_t>(big_endian_at(datagram, 2, 2));
  request.id = static_cast<std::uint16_t>(big_endian_at(datagram, 6, 2));
  if (request.id == 0) return std::nullopt;
  request.payload = datagram.subspan(header_bytes);
  return request;
}

Bytes gvcp_acknowledge(const GvcpRequest& request, GvcpStatus status, std::span<const std::uint8_t> payload) {
  Bytes out;
  out.reserve(header_bytes + payload.size());
  append_big_endian(out, static_cast<std::uint16_t>(status), 2);
  append_big_endian(out, request.command + 1U, 2);
  append_big_endian(out, payload.size(), 2);
  append_big_endian(out, request.id, 2);
  out.insert(out.end(), payload.begin(), payload.end());
  return out;
}

std::optional<ResendRequest> parse_resend_request(std::span<const std::uint8_t> payload) {
  if (payload.size() < 12) return std::nullopt;
  ResendRequest request;
  request.block_id = static_cast<std::uint16_t>(big_endian_at(payload, 2, 2));
  request.first_packet = static_cast<std::uint32_t>(big_endian_at(payload, 4, 4)) & packet_id_mask;
  request.last_packet = static_cast<std::uint32_t>(big_endian_at(payload, 8, 4)) & packet_id_mask;
  if (request.last_packet < request.first_packet) return std::nullopt;
  return request;
}

}  // namespace todbench
