// SPDX-License-Identifier: GPL-3.0-or-later
// CTF over frequency.
#pragma once

#include <optional>

#include "bench/report/document.h"
#include "bench/session/measures_record.h"

namespace todbench {

/// Returns one figure per axis: best and worst sampling phase of every bar group of the camera (of the simulated sensor
/// if not `camera`) and of the twin, and the closed form. Empty if no CTF was measured.
[[nodiscard]] std::optional<FigurePairs> ctf_figures(const SessionMeasures& measures, bool camera);

}  // namespace todbench
