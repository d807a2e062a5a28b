// SPDX-License-Identifier: GPL-3.0-or-later
// Residuals of binary answers from a fit that uses the function of a twin.
#pragma once

#include <optional>
#include <span>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/model_test.h"

namespace todbench {

/// Returns the scatter about the fitted function, as dispersions() does. Empty for graded answers (because their
/// scatter is estimated), for a fit without the function of a twin, and if all answers form one cluster.
[[nodiscard]] std::optional<Dispersions> twin_dispersions(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

/// Tests a free lapse against the fixed lapse of `fit`, with this probability of a false alarm; both fits use the
/// function of the twin. Empty if a larger lapse does not improve the fit, or with fewer than two clusters.
[[nodiscard]] std::optional<LapseTest> twin_lapse_test(const PsychometricFit& fit, const PsychometricFit& free_fit,
                                                       double probability);

}  // namespace todbench
