// A camera whose frames are recorded on their way.
#pragma once

#include <memory>

#include "acquisition/recording/frame_stream.h"

namespace todbench {

/// Hands on what `camera` does and appends every frame and every failure of next() and of a correction to `stream`
/// before it returns them. When the disk refuses, next() fails with `io`. The stream is shared with whoever appends
/// readings to it.
[[nodiscard]] std::unique_ptr<FrameSource> recording_camera(std::unique_ptr<FrameSource> camera,
                                                            std::shared_ptr<FrameStreamWriter> stream);

}  // namespace todbench
