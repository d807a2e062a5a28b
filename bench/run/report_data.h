// SPDX-License-Identifier: GPL-3.0-or-later
// Report data of a session.
#pragma once

#include <filesystem>
#include <string>

#include "bench/report/report.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// Returns the name of a session. This is the name of its folder, regardless of the form of the path.
[[nodiscard]] std::string session_name(const std::filesystem::path& folder);

/// Reads the data for render_report() from a session. `name`: name of the session. Errors: `invalid_input` if a plate
/// or sensor of the plan cannot be read.
[[nodiscard]] Result<ReportData> report_data(const Session& session, const std::string& name);

}  // namespace todbench
