// Frame identifiers as cameras send them to an exposure count that never wraps.
#pragma once

#include <cstdint>
#include <optional>

namespace todbench {

/// How a transport numbers frames.
enum class FrameIdKind {
  gvsp16,  ///< GigE Vision without extended ids: 16 bits, 65535 is followed by 1, 0 is never sent
  wide,    ///< 64 bits, never wraps: GigE Vision with extended ids, USB3 Vision
};

/// Turns frame ids into Frame::sequence: 0 for the first frame of a stream, gaps where exposures were lost.
/// Frames must be given in the order in which the transport completed them. One thread at a time.
class FrameSequence {
 public:
  explicit FrameSequence(FrameIdKind kind) : kind_(kind) {}

  /// Sequence of the frame `frame_id`; nothing when its id was lost with its leader packet. A frame without id gets the
  /// place after the last one: its true place can only be that or later, because the ids of the frames round it differ
  /// from its own. 16-bit ids are unwrapped over gaps of up to 32767 frames (ten minutes at 50 Hz); a smaller id within
  /// that distance is an older frame and gets its older sequence.
  [[nodiscard]] std::uint64_t next(std::optional<std::uint64_t> frame_id);

 private:
  FrameIdKind kind_;
  bool started_ = false;
  std::optional<std::uint64_t> anchor_id_;  ///< the id of ...
  std::uint64_t anchor_sequence_ = 0;       ///< ... the last frame that had one
  std::uint64_t last_ = 0;
};

}  // namespace todbench
