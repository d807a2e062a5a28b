// A session that another process writes, as it grows.
#pragma once

#include <filesystem>
#include <stop_token>

#include "bench/cli/console.h"

namespace todbench {

/// Shows the curve of a session folder until the session has ended or `stop` is requested; changes nothing in it.
/// Returns the exit code: that of the session's verdict, or of the error.
[[nodiscard]] int watch_session(Console& console, const std::filesystem::path& folder, const std::stop_token& stop);

}  // namespace todbench
