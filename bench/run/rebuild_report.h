// The report of a session that was written before, made again into its folder.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/report/report.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// Writes pages of a report into a folder and names them, relative to it.
using PageWriter = std::function<Result<std::vector<std::string>>(const ReportData& data)>;

/// What a report of the session says: report_data() with the answers of a person, where there are any. `session` comes
/// from open_session(). Errors: as report_data(), read_human().
[[nodiscard]] Result<ReportData> report_data_of(const Session& session, const std::filesystem::path& folder);

/// Keeps a verdict that had to be made, lets `write_pages` write, and brings the manifest up to date with both. The
/// A signed session is refused. The
/// manifest of a session whose changed files were accepted stays as it is, so that it goes on telling of them. `io`
/// with the path; errors of report_data_of() and of `write_pages`.
[[nodiscard]] Result<ReportData> rebuild_report(const Session& session, const std::filesystem::path& folder,
                                                const PageWriter& write_pages);
/// Of a signed session: the report as a revision of its own, in revisions/. `invalid_input`: as next_revision().
[[nodiscard]] Result<ReportData> revise_report(const Session& session, const std::filesystem::path& folder,
                                               const std::string& reason, const std::string& utc);
/// Writes report.html and report.csv.
[[nodiscard]] PageWriter html_page(std::filesystem::path folder);
/// The same with a letterhead, which the session keeps for every later report.
[[nodiscard]] PageWriter html_page_with(std::filesystem::path folder, Letterhead letterhead);

}  // namespace todbench
