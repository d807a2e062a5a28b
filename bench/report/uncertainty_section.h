// The section of a report that says what the expanded intervals hold.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// Nothing where the plan has no budget.
[[nodiscard]] std::optional<Section> uncertainty_section(const ReportData& data);

}  // namespace todbench
