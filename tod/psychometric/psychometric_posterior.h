// SPDX-License-Identifier: GPL-3.0-or-later
// Posterior of the threshold on an adaptive grid.
#pragma once

#include <optional>
#include <vector>

#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// Computes the posterior. Prior: ln threshold uniform from a tenth of the smallest to ten times the largest positive
/// size; ln slope normal about ln 3.5 with standard deviation 0.6, truncated to the slope domain; lapse fixed, or
/// uniform in [0, 0.1]. The grid is re-centred and refined until two conditions are met: the grid contains all
/// densities above 1e-7 of the peak, and doubling the number of steps changes the quantiles by at most 1e-4 of the
/// interval. `nodes`: result of scan_likelihood(). Assumes independent trials.
[[nodiscard]] Posterior grid_posterior(const PooledCounts& counts, PsychometricForm form, std::vector<ScanNode> nodes,
                                       std::optional<double> lapse);

}  // namespace todbench
