// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and spatial noise of a camera over the time since its correction.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns the figures; empty if no drift was measured.
[[nodiscard]] std::optional<FigurePairs> drift_figures(const SessionMeasures& measures);

}  // namespace todbench
