// SPDX-License-Identifier: GPL-3.0-or-later
// Exact tests of the answers at single sizes: fewer correct answers than guessing gives, and answers that no step
// function gives.
#pragma once

#include <optional>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Permitted false alarms of each of these tests, over all sizes.
inline constexpr double false_alarms_of_contradiction = 0.001;

/// Size at which the answers contradict the proportion that they were expected to have.
struct Contradiction {
  double size = 0;
  double correct = 0, total = 0;  ///< answers at this size
  double expected = 0;            ///< the nearest allowed proportion of correct answers
  double p = 1;                   ///< probability of such a contradiction at any of the sizes (Bonferroni)
};

/// Returns the size whose answers contradict chance level most: fewer correct answers than guesses give, by the
/// binomial distribution. Empty: p is above `probability` at every size. For counts of binary answers. If the answers
/// of a size come from several clusters, its counts are divided by the ratio of the clustered to the binomial variance.
[[nodiscard]] std::optional<Contradiction> below_chance(std::span<const Level> levels, double probability);

/// The same for a fit with the verdict step. Allowed are the proportions between those of the fitted function and those
/// of the infinitely steep function with the same threshold, on both sides. Empty also without threshold or slope.
[[nodiscard]] std::optional<Contradiction> contradicts_step(std::span<const Level> levels, const PsychometricFit& fit,
                                                            PsychometricForm form, double probability);

}  // namespace todbench
