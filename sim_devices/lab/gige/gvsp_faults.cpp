// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/lab/gige/gvsp_faults.h"

#include <utility>

namespace todbench {
namespace {

/// Positions of the draws for a whole frame. They are separate, so that one probability never changes another draw.
enum FrameDraw : std::uint64_t {
  draw_lost,
  draw_frozen,
  draw_swapped,
  draw_wrong_size,
  draw_late_leader,
  draw_too_long,
  draw_surplus
};
/// Draws per packet, after those of the frame.
enum PacketDraw : std::uint64_t { draw_loss, draw_duplicate, draw_reorder, draws_per_packet };
constexpr std::uint64_t first_packet_draw = 16;

bool happens(double probability, const RandomStream& random, std::uint64_t position) {
  return probability > 0 && random.uniform(position) < probability;
}

/// From one byte to more than one packet.
std::size_t surplus_of(const RandomStream& random) {
  return static_cast<std::size_t>(1) << static_cast<unsigned>(random.uniform(draw_surplus) * 15);
}

}  // namespace

FrameFaults draw_frame_faults(const GvspFaults& faults, const RandomStream& random, std::uint64_t exposure) {
  const RandomStream frame = random.sub(exposure);
  return {.lost = happens(faults.lost_frame, frame, draw_lost),
          .frozen = exposure > 0 && happens(faults.frozen, frame, draw_frozen),
          .swapped_bytes = happens(faults.swapped_bytes, frame, draw_swapped),
          .wrong_size = happens(faults.wrong_size, frame, draw_wrong_size),
          .late_leader = happens(faults.late_leader, frame, draw_late_leader),
          .surplus_bytes = happens(faults.too_long, frame, draw_too_long) ? surplus_of(frame) : 0};
}

PacketSchedule schedule_packets(std::uint32_t packets, const FrameFaults& planned, const GvspFaults& faults,
                                const RandomStream& random, std::uint64_t exposure) {
  const RandomStream frame = random.sub(exposure);
  std::vector<std::uint32_t> order;
  order.reserve(packets);
  for (std::uint32_t id = planned.late_leader ? 1 : 0; id < packets; ++id) order.push_back(id);
  if (planned.late_leader) order.push_back(0);
  const auto draw = [&](std::uint32_t id, PacketDraw what) {
    return first_packet_draw + draws_per_packet * std::uint64_t{id} + what;
  };
  PacketSchedule out;
  for (std::size_t i = 0; i + 1 < order.size(); ++i) {
    if (!happens(faults.reorder, frame, draw(order[i], draw_reorder))) continue;
    std::swap(order[i], order[i + 1]);
    ++out.reordered;
    ++i;  // a packet changes places once
  }
  out.ids.reserve(order.size());
  for (const auto id : order) {
    if (happens(faults.packet_loss, frame, draw(id, draw_loss))) {
      ++out.lost;
      continue;
    }
    out.ids.push_back(id);
    if (!happens(faults.duplicate, frame, draw(id, draw_duplicate))) continue;
    out.ids.push_back(id);
    ++out.duplicated;
  }
  return out;
}

}  // namespace todbench
