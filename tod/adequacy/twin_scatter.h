// What a fit with the function of a twin leaves of right and wrong answers.
#pragma once

#include <optional>
#include <span>

#include "tod/adequacy/dispersion.h"
#include "tod/adequacy/model_test.h"

namespace todbench {

/// Scatter about the fitted function, as dispersions(). Nothing of graded answers, whose scatter is estimated, of a fit
/// that has no function of a twin, and where all answers are one cluster.
[[nodiscard]] std::optional<Dispersions> twin_dispersions(std::span<const Level> levels, const PsychometricFit& fit,
                                                          const FitOptions& options);

/// A free lapse against the fixed one of `fit`, at this probability of a false alarm; both with the function of the
/// twin. Nothing where the answers ask for no larger lapse.
[[nodiscard]] std::optional<LapseTest> twin_lapse_test(const PsychometricFit& fit, const PsychometricFit& free_fit,
                                                       double probability);

}  // namespace todbench
