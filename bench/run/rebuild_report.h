// SPDX-License-Identifier: GPL-3.0-or-later
// Rebuilds the report of an existing session in its folder.
#pragma once

#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/report/report.h"
#include "bench/session/session_folder.h"

namespace todbench {

/// Writes pages of a report into a folder and returns their names, relative to the folder.
using PageWriter = std::function<Result<std::vector<std::string>>(const ReportData& data)>;

/// Returns the content of a session's report: report_data() with the answers of a person, if there are any. `session`
/// comes from open_session(). Errors: those of report_data() and read_human().
[[nodiscard]] Result<ReportData> report_data_of(const Session& session, const std::filesystem::path& folder);

/// Stores the verdict if the session had none, calls `write_pages`, and lists verdict and pages in the manifest. A
/// signed session is rejected. If changed files of a session were accepted, its manifest stays unchanged, so that later
/// checks still report the changes. Errors: `io` with the path; those of report_data_of() and `write_pages`.
[[nodiscard]] Result<ReportData> rebuild_report(const Session& session, const std::filesystem::path& folder,
                                                const PageWriter& write_pages);
/// Writes the report of a signed session as a revision in revisions/, signed with the key of the session. Errors:
/// `invalid_input`: as next_revision(), a foreign file, or a different key.
[[nodiscard]] Result<ReportData> revise_report(const Session& session, const std::filesystem::path& folder,
                                               const std::string& reason, const std::string& utc,
                                               const std::filesystem::path& secret_key,
                                               const std::stop_token& stop = {});
/// File of the order in a session.
inline constexpr std::string_view order_file = "inputs/order.toml";
/// Returns a function that calls `write` with an order (a file with a section [order]). The session stores the order
/// for later reports. Errors: those of load_order(), `io`.
[[nodiscard]] Result<PageWriter> with_order(std::filesystem::path folder, const std::filesystem::path& order,
                                            PageWriter write);
/// Returns a function that writes report.html and report.csv.
[[nodiscard]] PageWriter html_page(std::filesystem::path folder);
/// Returns the same function with a letterhead. The session stores the letterhead for later reports.
[[nodiscard]] PageWriter html_page_with(std::filesystem::path folder, Letterhead letterhead);

}  // namespace todbench
