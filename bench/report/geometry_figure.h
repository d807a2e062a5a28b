// The map of what the fitted lens leaves of the places of a plate's triangles.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Of the camera and of the twin; nothing where neither was measured.
[[nodiscard]] std::optional<FigurePairs> geometry_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
