// Pictures of every view, as they are after a run on the emulated laboratory.
#pragma once

#include <filesystem>

#include "bench/gui/views/main_window.h"

namespace todbench {

/// Drives the window through its views and writes one PNG per view into `folder`. Returns the exit code of the program.
[[nodiscard]] int take_screenshots(MainWindow& window, const std::filesystem::path& folder);

}  // namespace todbench
