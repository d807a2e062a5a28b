// Signal transfer: contrast seen over contrast shown, and what the straight line leaves.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Of camera and twin; nothing where neither was measured.
[[nodiscard]] std::optional<FigurePairs> transfer_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
