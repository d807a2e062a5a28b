// SPDX-License-Identifier: GPL-3.0-or-later
// Signal transfer: observed contrast over target read-back, and the residuals of the straight line.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns the figures of camera and twin; empty if neither was measured.
[[nodiscard]] std::optional<FigurePairs> transfer_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
