// Pictures of every view, as they are after a run on the emulated laboratory.
#pragma once

#include <filesystem>

#include "bench/gui/views/main_window.h"

namespace todbench {

/// Drives the window through its views and writes one PNG per view into `folder`. Returns the exit code of the program.
[[nodiscard]] int take_screenshots(MainWindow& window, const std::filesystem::path& folder);

/// The pages that need no camera: the first one, the plan, and the report of a session. The same result.
[[nodiscard]] int take_session_screenshots(MainWindow& window, const std::filesystem::path& folder,
                                           const std::filesystem::path& session);

}  // namespace todbench
