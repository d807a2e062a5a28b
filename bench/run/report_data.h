// A session as the report shows it.
#pragma once

#include <filesystem>
#include <string>

#include "bench/report/report.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// The name of a session: that of its folder, however the folder is referred to.
[[nodiscard]] std::string session_name(const std::filesystem::path& folder);

/// Everything for render_report() from what the session folder holds. `name` is that of the session. `invalid_input`
/// when a plate or sensor that the plan names cannot be read.
[[nodiscard]] Result<ReportData> report_data(const Session& session, const std::string& name);

}  // namespace todbench
