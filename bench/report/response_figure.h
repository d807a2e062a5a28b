// What is left of a step of the target over the time since it.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Nothing where no response time was measured.
[[nodiscard]] std::optional<FigurePairs> response_figure(const SessionMeasures& measures, bool camera);

}  // namespace todbench
