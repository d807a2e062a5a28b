// Documents as PDF: the same sections, tables and figures as the page, the figures as vectors.
#pragma once

#include <filesystem>

#include "acquisition/core/result.h"
#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// A4 pages with the label of the document and the page number at the foot, written beside the file and renamed over
/// it. Any thread, as long as a QGuiApplication lives. `io` with the path.
[[nodiscard]] Result<void> write_pdf(const Document& document, const std::filesystem::path& file);
/// write_pdf() of the report.
[[nodiscard]] Result<void> write_pdf_report(const ReportData& data, const std::filesystem::path& file);

}  // namespace todbench
