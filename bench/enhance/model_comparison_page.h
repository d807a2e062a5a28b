// The comparison of two models as a page.
#pragma once

#include "bench/enhance/model_comparison.h"
#include "bench/report/document.h"

namespace todbench {

/// Where they part, curves, transfer functions, differences of pixels and of keys, where the models come from. No times
/// of day, no hosts.
[[nodiscard]] Document model_comparison_page(const LoadedPlan& plan, const ModelComparison& comparison);

}  // namespace todbench
