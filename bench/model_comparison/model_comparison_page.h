// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two models as a page.
#pragma once

#include "bench/model_comparison/model_comparison.h"
#include "bench/report/document.h"

namespace todbench {

/// Returns a page with the deviations, curves, transfer functions, differences of pixels and keys, and the sources of
/// the models. The page contains no times of day and no host names.
[[nodiscard]] Document model_comparison_page(const LoadedPlan& plan, const ModelComparison& comparison);

}  // namespace todbench
