// SPDX-License-Identifier: GPL-3.0-or-later
// Residuals of right and wrong answers from a fit with the function of a twin.
#pragma once

#include <optional>
#include <span>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/model_test.h"

namespace todbench {

/// Scatter about the fitted function, as dispersions(). Empty for graded answers (their scatter is estimated), for a
/// fit without a twin's function, and if all answers are one cluster.
[[nodiscard]] std::optional<Dispersions> twin_dispersions(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

/// Test of a free lapse against the fixed one of `fit` at this probability of a false alarm; both fits use the function
/// of the twin. Empty if the answers do not call for a larger lapse.
[[nodiscard]] std::optional<LapseTest> twin_lapse_test(const PsychometricFit& fit, const PsychometricFit& free_fit,
                                                       double probability);

}  // namespace todbench
