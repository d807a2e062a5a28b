// The answers of a sweep as a page.
#pragma once

#include "bench/report/document.h"
#include "bench/sweep/sweep_effects.h"

namespace todbench {

/// Response tables and curves, main effects as a tornado, shares of variance with their intervals, and the contours of
/// the two parameters that matter most; for every contrast of `effects`. A pure function: no times, no hosts.
[[nodiscard]] Document sweep_page(const Sweep& sweep, const SweepTable& table,
                                  const std::vector<ResponseEffects>& effects);

}  // namespace todbench
