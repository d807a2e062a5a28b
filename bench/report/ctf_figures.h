// The contrast transfer over frequency.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// One figure an axis: best and worst sampling phase of every group of bars of the camera (`camera`; else of the
/// simulated sensor) and of the twin, and the closed form. Nothing where no CTF was measured.
[[nodiscard]] std::optional<FigurePairs> ctf_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
