// The report as PDF: the same sections, tables and figures as the page, the figures as vectors.
#pragma once

#include <QString>
#include <filesystem>

#include "acquisition/core/result.h"
#include "bench/report/report.h"

namespace todbench {

/// A4 pages with name of the session and page number at the foot, written beside the file and renamed over it. Any
/// thread, as long as a QGuiApplication lives. `io` with the path.
[[nodiscard]] Result<void> write_pdf_report(const ReportData& data, const std::filesystem::path& file);

/// render_report() in the part of HTML that QTextDocument knows; figure number k of the page is the text "@@k@@" in a
/// paragraph of its own.
[[nodiscard]] QString rich_text(const std::string& report_html);

}  // namespace todbench
