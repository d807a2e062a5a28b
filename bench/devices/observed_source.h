// SPDX-License-Identifier: GPL-3.0-or-later
// Camera with a second listener to its frames.
#pragma once

#include <functional>
#include <memory>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// Returns `camera` with a callback: `on_frame` receives every frame that next() returns, on the thread that calls
/// next().
[[nodiscard]] std::unique_ptr<FrameSource> observed_source(std::unique_ptr<FrameSource> camera,
                                                           std::function<void(const Frame&)> on_frame);

}  // namespace todbench
