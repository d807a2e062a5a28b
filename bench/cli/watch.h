// SPDX-License-Identifier: GPL-3.0-or-later
// Display of a session that another process is writing.
#pragma once

#include <filesystem>
#include <stop_token>

#include "bench/cli/console.h"

namespace todbench {

/// Shows the curve of a session folder until the session has ended or `stop` is requested; only reads the folder.
/// Returns the exit code of the verdict of the session, or of the error.
[[nodiscard]] int watch_session(Console& console, const std::filesystem::path& folder, const std::stop_token& stop);

}  // namespace todbench
