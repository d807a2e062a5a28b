// The comparison of packages as a page and as a picture.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/loaded_plan.h"
#include "bench/report/document.h"

namespace todbench {

/// Curves beside that of none, ratios with paired intervals, times, what failed, where the packages come from. No times
/// of day, no hosts.
[[nodiscard]] Document enhancement_page(const LoadedPlan& loaded, const std::vector<EnhancementPackage>& packages,
                                        const Enhancement& enhancement);

/// The pictures from left to right in the order of the results, eight white columns between them, each from its 0.1 %
/// darkest to its 0.1 % brightest value as 8 bits. Empty where there is no picture.
[[nodiscard]] cv::Mat1b side_by_side(const Enhancement& enhancement);

}  // namespace todbench
