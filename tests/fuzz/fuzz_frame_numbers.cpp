// SPDX-License-Identifier: GPL-3.0-or-later
// Any numbers and times as those of a stream of frames: each gets a place, and where numbers began anew it is behind
// all that were given before.
#include <algorithm>
#include <cstring>

#include "acquisition/core/frame_sequence.h"
#include "tests/fuzz/fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace todbench;
  constexpr FrameNumberKind kinds[] = {FrameNumberKind::gvsp16, FrameNumberKind::gvsp64, FrameNumberKind::wide,
                                       FrameNumberKind::wrap32, FrameNumberKind::wrap16};
  constexpr double rates[] = {0, 9, 50, 1000, -1, 1e300};
  constexpr std::size_t head = 2, record = 20;
  if (size < head) return 0;
  FrameSequence sequence(kinds[data[0] % 5], rates[data[1] % 6]);
  std::int64_t host_ns = 1'000'000'000;
  std::uint64_t highest = 0;
  std::uint64_t since = 0;  ///< ns
  bool begun = false;
  for (std::size_t at = head; at + record <= size; at += record) {
    FrameStamp stamp;
    std::uint64_t number = 0;
    std::uint32_t later_ns = 0;
    std::memcpy(&number, data + at, 8);
    std::memcpy(&stamp.device_time_ns, data + at + 8, 8);
    std::memcpy(&later_ns, data + at + 16, 4);
    if (number % 31 != 30) stamp.number = number;
    stamp.may_pause = number % 7 == 6;
    host_ns += later_ns;
    stamp.host_time_ns = host_ns;

    const FramePlace place = sequence.next(stamp);

    fuzz::require(place.numbering == Numbering::counted || !begun || place.sequence > highest);
    // Numbers are bounded by the time that passed, 4.3 s for a record, at 10 kHz, with a slack of a second.
    const std::uint64_t most = 100'000;
    since += later_ns;
    fuzz::require(place.sequence <= highest + most * (1 + since / 4'000'000'000U));
    if (stamp.number && place.sequence > highest) since = 0;
    highest = std::max(highest, place.sequence);
    begun = true;
  }
  return 0;
}
