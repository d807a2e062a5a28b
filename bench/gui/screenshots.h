// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of every view after a run in the emulated laboratory.
#pragma once

#include <filesystem>

#include "bench/gui/views/main_window.h"

namespace todbench {

/// Shows the views of the window one after the other and writes one PNG per view into `folder`. Returns the exit code
/// of the program.
[[nodiscard]] int take_screenshots(MainWindow& window, const std::filesystem::path& folder);

/// Writes the pages without a camera: the start page, the plan, and the report of a session. Returns the exit code of
/// the program.
[[nodiscard]] int take_session_screenshots(MainWindow& window, const std::filesystem::path& folder,
                                           const std::filesystem::path& session);

}  // namespace todbench
