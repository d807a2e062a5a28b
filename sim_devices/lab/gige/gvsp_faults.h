// SPDX-License-Identifier: GPL-3.0-or-later
// Transmission faults between an emulated camera and its client, drawn in advance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "acquisition/base/rng.h"

namespace todbench {

/// Random faults. Each number is the probability of a fault, 0 ... 1. Faults are drawn independently of each other.
struct GvspFaults {
  double packet_loss = 0;    ///< a packet is lost; includes leaders, trailers and resent packets
  double duplicate = 0;      ///< a packet is sent twice
  double reorder = 0;        ///< a packet is exchanged with the next packet
  double late_leader = 0;    ///< the leader of a frame is sent after the trailer
  double lost_frame = 0;     ///< a frame is exposed and numbered, but never sent
  double frozen = 0;         ///< a frame repeats the picture of the previous frame
  double swapped_bytes = 0;  ///< the two bytes of every pixel of a frame are exchanged
  double wrong_size = 0;     ///< a frame contains half of its rows, and the leader states this height
  double too_long = 0;       ///< a frame contains undeclared bytes after the payload
  bool operator==(const GvspFaults&) const = default;
};

/// Counts of the faults of GvspFaults, in the same order.
struct GvspFaultCounts {
  std::uint64_t packets_lost = 0, packets_duplicated = 0, packets_reordered = 0;
  std::uint64_t late_leaders = 0, frames_lost = 0, frames_frozen = 0, frames_swapped = 0, frames_wrong_size = 0;
  std::uint64_t frames_too_long = 0;
  std::uint64_t frames_with_holes = 0;  ///< frames that lost at least one packet in the first transmission
};

/// Faults of one exposure as a whole.
struct FrameFaults {
  bool lost = false, frozen = false, swapped_bytes = false, wrong_size = false, late_leader = false;
  std::size_t surplus_bytes = 0;  ///< undeclared bytes after the payload
};

/// Draws the faults of an exposure. The faults depend only on `random` and `exposure`, not on earlier calls.
[[nodiscard]] FrameFaults draw_frame_faults(const GvspFaults& faults, const RandomStream& random,
                                            std::uint64_t exposure);

/// Order in which the packets of a frame are sent: packet ids, some of them missing, repeated or exchanged, and the
/// numbers of missing, repeated and exchanged packets.
struct PacketSchedule {
  std::vector<std::uint32_t> ids;
  std::uint64_t lost = 0, duplicated = 0, reordered = 0;
};
/// Returns the order of the packets. The order depends only on the arguments.
[[nodiscard]] PacketSchedule schedule_packets(std::uint32_t packets, const FrameFaults& planned,
                                              const GvspFaults& faults, const RandomStream& random,
                                              std::uint64_t exposure);

}  // namespace todbench
