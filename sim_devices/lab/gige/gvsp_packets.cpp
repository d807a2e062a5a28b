// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvsp_packets.h"

#include <algorithm>
#include <cassert>

namespace todbench {
namespace {

enum class Content : std::uint8_t { leader = 1, trailer = 2, payload = 3 };

Bytes header(std::uint16_t status, std::uint16_t block_id, Content content, std::uint32_t packet_id) {
  Bytes out;
  out.reserve(44);
  append_big_endian(out, status, 2);
  append_big_endian(out, block_id, 2);
  append_big_endian(out, static_cast<std::uint8_t>(content), 1);
  append_big_endian(out, packet_id, 3);
  return out;
}

void append_leader(Bytes& out, const GvspFrame& frame) {
  append_big_endian(out, 0, 2);
  append_big_endian(out, frame.payload_type, 2);
  append_big_endian(out, frame.timestamp_ns, 8);
  append_big_endian(out, frame.pixel_format, 4);
  append_big_endian(out, frame.width, 4);
  append_big_endian(out, frame.height, 4);
  for (int i = 0; i < 2; ++i) append_big_endian(out, 0, 4);  // offsets x and y
  append_big_endian(out, frame.x_padding, 2);
  append_big_endian(out, frame.y_padding, 2);
}

GvspPacket packet_of(const Bytes& head, std::span<const std::uint8_t> data) {
  GvspPacket packet;
  assert(head.size() <= packet.head.size());
  std::copy(head.begin(), head.end(), packet.head.begin());
  packet.head_bytes = head.size();
  packet.data = data;
  return packet;
}

}  // namespace

std::uint32_t GvspFrame::packets() const {
  return static_cast<std::uint32_t>((data.size() + bytes_per_packet - 1) / bytes_per_packet) + 2;
}

GvspPacket gvsp_packet(const GvspFrame& frame, std::uint32_t id, std::uint16_t status) {
  assert(id < frame.packets());
  const bool leader = id == 0;
  const bool trailer = id == frame.packets() - 1;
  const Content content = leader ? Content::leader : trailer ? Content::trailer : Content::payload;
  Bytes head = header(status, frame.block_id, content, id);
  if (leader) {
    append_leader(head, frame);
    return packet_of(head, {});
  }
  if (trailer) {
    append_big_endian(head, 0, 2);
    append_big_endian(head, frame.payload_type, 2);
    append_big_endian(head, frame.height, 4);
    return packet_of(head, {});
  }
  const std::size_t begin = (id - 1) * frame.bytes_per_packet;
  const std::size_t bytes = std::min(frame.bytes_per_packet, frame.data.size() - begin);
  return packet_of(head, std::span(frame.data).subspan(begin, bytes));
}

GvspPacket gvsp_unavailable(std::uint16_t block_id, std::uint32_t id) {
  return packet_of(header(gvsp_status_packet_unavailable, block_id, Content::payload, id), {});
}

void append_chunk(Bytes& data, std::uint32_t chunk_id, std::span<const std::uint8_t> content) {
  data.insert(data.end(), content.begin(), content.end());
  append_big_endian(data, chunk_id, 4);
  append_big_endian(data, content.size(), 4);
}

}  // namespace todbench
