// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a sweep as a page.
#pragma once

#include "bench/report/document.h"
#include "bench/sweep/sweep_effects.h"

namespace todbench {

/// Returns the page. For every contrast of `effects` it contains response tables and curves, main effects as a tornado,
/// shares of variance with their intervals, and contours of the two most important parameters. A pure function. The
/// page contains no times and no host names.
[[nodiscard]] Document sweep_page(const Sweep& sweep, const SweepTable& table,
                                  const std::vector<ResponseEffects>& effects);

}  // namespace todbench
