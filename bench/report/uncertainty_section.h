// SPDX-License-Identifier: GPL-3.0-or-later
// Section of a report that lists the sources of uncertainty in the expanded intervals.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// Returns the section; empty if the plan has no budget.
[[nodiscard]] std::optional<Section> uncertainty_section(const ReportData& data);

}  // namespace todbench
