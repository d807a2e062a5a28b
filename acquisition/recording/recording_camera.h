// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that appends all delivered frames to a recording.
#pragma once

#include <memory>

#include "acquisition/recording/frame_stream.h"

namespace todbench {

/// Forwards all calls to `camera`. Appends every frame, every failure of next() and every failure of a correction to
/// `stream` before the call returns. next() fails with `io` if a record cannot be written. The code that appends
/// readings uses the same stream.
[[nodiscard]] std::unique_ptr<FrameSource> recording_camera(std::unique_ptr<FrameSource> camera,
                                                            std::shared_ptr<FrameStreamWriter> stream);

}  // namespace todbench
