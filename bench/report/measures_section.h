// The section of physical measures.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// Camera beside twin; nothing where nothing was measured.
[[nodiscard]] std::optional<Section> measures_section(const ReportData& data);

}  // namespace todbench
