// SPDX-License-Identifier: GPL-3.0-or-later
// Remaining part of a step of the target over the time since the step.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns the figures; empty if no response time was measured.
[[nodiscard]] std::optional<FigurePairs> response_figure(const SessionMeasures& measures, bool camera);

}  // namespace todbench
