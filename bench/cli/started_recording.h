// SPDX-License-Identifier: GPL-3.0-or-later
// A recording as the input of a command.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/frame_source.h"
#include "bench/cli/console.h"

namespace todbench {

/// Opens and starts the recording `id` (file name or id), and prints its warnings.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> started_recording(Console& console, const std::string& id);

}  // namespace todbench
