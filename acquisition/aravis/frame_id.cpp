#include "acquisition/aravis/frame_id.h"

#include <algorithm>

namespace todbench {
namespace {

/// Ids 1 ... 65535 repeat with this period because 0 is skipped.
constexpr std::int64_t gvsp16_period = 65535;

std::int64_t distance(FrameIdKind kind, std::uint64_t from, std::uint64_t to) {
  const auto difference = static_cast<std::int64_t>(to - from);
  if (kind == FrameIdKind::wide) return difference;
  const std::int64_t forward = ((difference % gvsp16_period) + gvsp16_period) % gvsp16_period;
  return forward <= gvsp16_period / 2 ? forward : forward - gvsp16_period;
}

}  // namespace

std::uint64_t FrameSequence::next(std::optional<std::uint64_t> frame_id) {
  std::uint64_t sequence = started_ ? last_ + 1 : 0;
  if (frame_id) {
    if (anchor_id_) {
      const std::int64_t at = static_cast<std::int64_t>(anchor_sequence_) + distance(kind_, *anchor_id_, *frame_id);
      sequence = static_cast<std::uint64_t>(std::max<std::int64_t>(at, 0));
    }
    anchor_id_ = frame_id;
    anchor_sequence_ = sequence;
  }
  started_ = true;
  last_ = sequence;
  return sequence;
}

}  // namespace todbench
