// SPDX-License-Identifier: GPL-3.0-or-later
// A recording as a camera.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// One recorded picture. Members that the recording does not state have their default values.
struct RecordedFrame {
  cv::Mat1w counts;
  std::int64_t device_time_ns = 0;        ///< 0: not stated
  std::optional<std::uint64_t> sequence;  ///< empty: the sequence number of the previous frame plus one
  std::int64_t host_time_ns = 0;          ///< time on the recording host; 0: not stated
  FrameStatus status = FrameStatus::complete;
  Numbering numbering = Numbering::counted;
  CorrectionState correction = CorrectionState::unknown;
  double since_correction_s = -1;
  std::optional<int> significant_bits;  ///< empty: as in the recording
};

/// The call of the recorded camera that failed.
enum class FailedCall { next, correct_nonuniformity };

/// A recorded failure of the camera. The failure replaces a frame or a correction.
struct RecordedFailure {
  std::uint64_t before_frame = 0;  ///< index of the next frame
  Error error;
  FailedCall call = FailedCall::next;
};

/// An opened recording: camera, number of frames, and a function that reads one frame. next() calls `read`, on the
/// thread of next(), with an index below `frame_count`. `read` owns all data that it uses.
struct Recording {
  SourceInfo info;
  std::uint64_t frame_count = 0;
  std::function<Result<RecordedFrame>(std::uint64_t index)> read;
  std::vector<RecordedFailure> failures{};  ///< in order; only a replay returns them
};

/// Source of the times and failures of a recording that is played back.
enum class Playback {
  camera,  ///< as from a live camera: host times are now, recorded failures are omitted
  replay,  ///< as recorded: recorded times and failures, also of non-uniformity corrections
};

/// Returns a source that serves the frames in order, as fast as they are requested. The sequence begins at 0 unless the
/// recording states otherwise. start() after stop() begins at the first frame again. The end of the recording and a
/// frame that has become unreadable are reported as `disconnected`. Features: the entries of info().settings,
/// read-only.
[[nodiscard]] std::unique_ptr<FrameSource> recorded_source(Recording recording, Playback playback = Playback::camera);

}  // namespace todbench
