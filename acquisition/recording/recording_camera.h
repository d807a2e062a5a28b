// SPDX-License-Identifier: GPL-3.0-or-later
// A camera whose frames are recorded as they pass through.
#pragma once

#include <memory>

#include "acquisition/recording/frame_stream.h"

namespace todbench {

/// Forwards every call to `camera`. Appends every frame and every failure of next() and of a correction to `stream`
/// before returning it. next() fails with `io` if a record cannot be written. The stream is shared with the writer of
/// readings.
[[nodiscard]] std::unique_ptr<FrameSource> recording_camera(std::unique_ptr<FrameSource> camera,
                                                            std::shared_ptr<FrameStreamWriter> stream);

}  // namespace todbench
