// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of packages as a page and as a picture.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "bench/enhance/enhancement.h"
#include "bench/plan/loaded_plan.h"
#include "bench/report/document.h"

namespace todbench {

/// Returns a page with the curves, compared with the curve without a package, the ratios with paired intervals, times,
/// failures, and the sources of the packages. The page contains no times of day and no host names.
[[nodiscard]] Document enhancement_page(const LoadedPlan& loaded, const std::vector<EnhancementPackage>& packages,
                                        const Enhancement& enhancement);

/// Returns the pictures from left to right in the order of the results, separated by eight white columns. Each picture
/// is scaled to 8 bits between its 0.1 % and 99.9 % quantiles. Empty if there is no picture.
[[nodiscard]] cv::Mat1b side_by_side(const Enhancement& enhancement);

}  // namespace todbench
