// SPDX-License-Identifier: GPL-3.0-or-later
// Map of the residuals of the triangles' positions after the lens fit.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns the figures of camera and twin; empty if neither was measured.
[[nodiscard]] std::optional<FigurePairs> geometry_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
