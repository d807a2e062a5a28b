// SPDX-License-Identifier: GPL-3.0-or-later
// Packets of one frame in the GigE Vision streaming protocol (GVSP). Source: GigE Vision 2.0, chapters 23 to 25.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sim_devices/lab/gige/big_endian.h"

namespace todbench {

/// Bytes that GevSCPSPacketSize counts in addition to the data of a packet: IPv4, UDP and GVSP headers.
inline constexpr std::size_t gvsp_overhead_bytes = 20 + 8 + 8;

inline constexpr std::uint16_t gvsp_status_success = 0x0000;
inline constexpr std::uint16_t gvsp_status_resent = 0x0100;
inline constexpr std::uint16_t gvsp_status_packet_unavailable = 0x800C;

/// One frame on the wire. Immutable after creation.
struct GvspFrame {
  std::uint16_t block_id = 1;
  std::uint64_t exposure = 0;
  std::uint64_t timestamp_ns = 0;
  std::uint32_t pixel_format = 0;
  std::uint32_t width = 0, height = 0;         ///< as the leader states them
  std::uint16_t x_padding = 0, y_padding = 0;  ///< as the leader states them, in bytes
  std::uint16_t payload_type = 0x0001;         ///< 0x4001 with chunks after the image
  std::size_t bytes_per_packet = 0;            ///< bytes of data in a packet
  Bytes data;                                  ///< image, then chunks

  /// Returns the number of packets: leader, data packets and trailer, with the ids 0 ... packets() - 1.
  [[nodiscard]] std::uint32_t packets() const;
};

/// A datagram in two parts, which avoids a second copy of the pixels: its head (the whole content of leader and
/// trailer) and a slice of GvspFrame::data.
struct GvspPacket {
  std::array<std::uint8_t, 44> head{};
  std::size_t head_bytes = 0;
  std::span<const std::uint8_t> data;  ///< view into the frame
};

/// Returns packet `id` of a frame. Precondition: id < frame.packets().
[[nodiscard]] GvspPacket gvsp_packet(const GvspFrame& frame, std::uint32_t id, std::uint16_t status);

/// Returns the response to a request for a packet that is no longer stored.
[[nodiscard]] GvspPacket gvsp_unavailable(std::uint16_t block_id, std::uint32_t id);

/// Appends one chunk: its data, then its id and length.
void append_chunk(Bytes& data, std::uint32_t chunk_id, std::span<const std::uint8_t> content);

}  // namespace todbench
