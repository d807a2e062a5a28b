// What goes wrong on the way from a camera to its client, decided in advance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "acquisition/core/rng.h"

namespace todbench {

/// Faults at random, each a probability 0 ... 1 that is drawn independently.
struct GvspFaults {
  double packet_loss = 0;    ///< per packet, leaders, trailers and resent packets too
  double duplicate = 0;      ///< per packet: sent twice
  double reorder = 0;        ///< per packet: changes places with the next one
  double late_leader = 0;    ///< per frame: the leader is sent after the trailer
  double lost_frame = 0;     ///< per frame: exposed, numbered and never sent
  double frozen = 0;         ///< per frame: carries the picture of the frame before it
  double swapped_bytes = 0;  ///< per frame: both bytes of every pixel change places
  double wrong_size = 0;     ///< per frame: has half its rows, and says so
  double too_long = 0;       ///< per frame: has bytes behind the payload that nothing speaks of
  bool operator==(const GvspFaults&) const = default;
};

/// What was done to the stream, in the same order.
struct GvspFaultCounts {
  std::uint64_t packets_lost = 0, packets_duplicated = 0, packets_reordered = 0;
  std::uint64_t late_leaders = 0, frames_lost = 0, frames_frozen = 0, frames_swapped = 0, frames_wrong_size = 0;
  std::uint64_t frames_too_long = 0;
  std::uint64_t frames_with_holes = 0;  ///< frames that lost at least one packet when first sent
};

/// The faults of one exposure as a whole.
struct FrameFaults {
  bool lost = false, frozen = false, swapped_bytes = false, wrong_size = false, late_leader = false;
  std::size_t surplus_bytes = 0;
};

/// A function of (random, exposure) alone: the same for the same seed whatever happened before.
[[nodiscard]] FrameFaults draw_frame_faults(const GvspFaults& faults, const RandomStream& random,
                                            std::uint64_t exposure);

/// In which order the packets of a frame go out: ids, some of them missing, repeated or exchanged. Adds to `counts`
/// what it did; a function of (random, exposure) otherwise.
struct PacketSchedule {
  std::vector<std::uint32_t> ids;
  std::uint64_t lost = 0, duplicated = 0, reordered = 0;
};
[[nodiscard]] PacketSchedule schedule_packets(std::uint32_t packets, const FrameFaults& planned,
                                              const GvspFaults& faults, const RandomStream& random,
                                              std::uint64_t exposure);

}  // namespace todbench
