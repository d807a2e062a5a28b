// A recording as a camera.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// One recorded picture. What a recording does not say is never made up.
struct RecordedFrame {
  cv::Mat1w counts;
  std::int64_t device_time_ns = 0;        ///< 0: not stated
  std::optional<std::uint64_t> sequence;  ///< nothing: one more than the frame before
  std::int64_t host_time_ns = 0;          ///< of the host that recorded it; 0: not stated
  FrameStatus status = FrameStatus::complete;
  Numbering numbering = Numbering::counted;
  CorrectionState correction = CorrectionState::unknown;
  double since_correction_s = -1;
  std::optional<int> significant_bits;  ///< nothing: those of the recording
};

/// What the recorded camera was asked for when it failed.
enum class FailedCall { next, correct_nonuniformity };

/// Something else than a frame, or than success, that the recorded camera answered with.
struct RecordedFailure {
  std::uint64_t before_frame = 0;  ///< index of the frame that came next
  Error error;
  FailedCall call = FailedCall::next;
};

/// An opened recording: who took it, how many frames, and how to read one. `read` is called from the thread of next()
/// with an index below `frame_count` and owns what it needs.
struct Recording {
  SourceInfo info;
  std::uint64_t frame_count = 0;
  std::function<Result<RecordedFrame>(std::uint64_t index)> read;
  std::vector<RecordedFailure> failures{};  ///< in order; only a replay answers with them
};

/// How a recording is served.
enum class Playback {
  camera,  ///< as a camera of now: the time of arrival is now, failures of then are left out
  replay,  ///< as it was: times of then, failures of then, also of a correction of the non-uniformity
};

/// Serves the frames in order, as fast as they are asked for, sequence 0 first unless the recording says otherwise.
/// start() after stop() begins at the first frame again. The end of the recording is `disconnected`, as is a frame that
/// cannot be read any more. Features: the entries of info().settings can be read; none can be written.
[[nodiscard]] std::unique_ptr<FrameSource> recorded_source(Recording recording, Playback playback = Playback::camera);

}  // namespace todbench
