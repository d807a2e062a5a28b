// A camera whose frames somebody else looks at too.
#pragma once

#include <functional>
#include <memory>

#include "acquisition/core/frame_source.h"

namespace todbench {

/// `camera` with every frame that next() returns shown to `on_frame` first, on the thread that calls next().
[[nodiscard]] std::unique_ptr<FrameSource> observed_source(std::unique_ptr<FrameSource> camera,
                                                           std::function<void(const Frame&)> on_frame);

}  // namespace todbench
