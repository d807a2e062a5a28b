// SPDX-License-Identifier: GPL-3.0-or-later
// Documents as PDF: the same sections, tables and figures as the page, with figures as vector graphics.
#pragma once

#include <filesystem>

#include "acquisition/base/result.h"
#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// Writes A4 pages with the label of the document and the page number in the footer, to a temporary file that is then
/// renamed. Any thread, while a QGuiApplication exists. Errors: `io` with the path.
[[nodiscard]] Result<void> write_pdf(const Document& document, const std::filesystem::path& file);
/// Calls write_pdf() for the report.
[[nodiscard]] Result<void> write_pdf_report(const ReportData& data, const std::filesystem::path& file);

}  // namespace todbench
