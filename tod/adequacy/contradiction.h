// SPDX-License-Identifier: GPL-3.0-or-later
// Exact tests of the answers at each size. The tests examine whether fewer answers are correct than expected from
// guessing, and whether the answers contradict every step function.
#pragma once

#include <optional>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Permitted probability of a false alarm of each of these tests, over all sizes.
inline constexpr double false_alarms_of_contradiction = 0.001;

/// A size at which the proportion of correct answers contradicts the expected proportion.
struct Contradiction {
  double size = 0;
  double correct = 0, total = 0;  ///< answers at this size
  double expected = 0;            ///< permitted proportion of correct answers that is nearest to the observed
                                  ///< proportion
  double p = 1;                   ///< probability that chance causes a contradiction of this magnitude at any of the
                                  ///< sizes (Bonferroni)
};

/// Tests by the binomial distribution whether fewer answers are correct than expected from guessing. Returns the size
/// with the smallest p. Empty if p is above `probability` at every size. For binary answers. If the answers of a size
/// come from several clusters, its counts are divided by the ratio of the clustered to the binomial variance.
[[nodiscard]] std::optional<Contradiction> below_chance(std::span<const Level> levels, double probability);

/// Tests whether the answers contradict a fit whose verdict is `step`. At each size, any proportion is permitted
/// between the fitted function and the infinitely steep function with the same threshold. Empty without a
/// contradiction, and if the fit has no threshold or no slope.
[[nodiscard]] std::optional<Contradiction> contradicts_step(std::span<const Level> levels, const PsychometricFit& fit,
                                                            PsychometricForm form, double probability);

}  // namespace todbench
