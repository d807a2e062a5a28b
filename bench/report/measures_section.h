// SPDX-License-Identifier: GPL-3.0-or-later
// Section of physical measures.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/report/report.h"

namespace todbench {

/// Returns the section with camera and twin side by side; empty if there are no measures.
[[nodiscard]] std::optional<Section> measures_section(const ReportData& data);

}  // namespace todbench
