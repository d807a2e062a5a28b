// A recording as a camera.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// One recorded picture.
struct RecordedFrame {
  cv::Mat1w counts;
  std::int64_t device_time_ns = 0;  ///< 0: the recording does not say; never made up
};

/// An opened recording: who took it, how many frames, and how to read one. `read` is called from the thread of next()
/// with an index below `frame_count` and owns what it needs.
struct Recording {
  SourceInfo info;
  std::uint64_t frame_count = 0;
  std::function<Result<RecordedFrame>(std::uint64_t index)> read;
};

/// Serves the frames in order, as fast as they are asked for, sequence 0 first. start() after stop() begins at the
/// first frame again. The end of the recording is `disconnected`, as is a frame that cannot be read any more. Features:
/// the entries of info().settings can be read; none can be written.
[[nodiscard]] std::unique_ptr<FrameSource> recorded_source(Recording recording);

}  // namespace todbench
