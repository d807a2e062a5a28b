// SPDX-License-Identifier: GPL-3.0-or-later
// Exact tests of the answers at single sizes: are there fewer correct answers than guessing yields, and answers that no
// step function yields?
#pragma once

#include <optional>
#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Permitted probability of a false alarm of each of these tests, over all sizes.
inline constexpr double false_alarms_of_contradiction = 0.001;

/// Size at which the answers contradict their expected proportion.
struct Contradiction {
  double size = 0;
  double correct = 0, total = 0;  ///< answers at this size
  double expected = 0;            ///< the nearest permitted proportion of correct answers
  double p = 1;                   ///< probability of such a contradiction at any of the sizes (Bonferroni)
};

/// Returns the size whose answers contradict chance level most: fewer correct answers than guesses yield, by the
/// binomial distribution. Empty if p is above `probability` at every size. For counts of binary answers. If the answers
/// of a size come from several clusters, its counts are divided by the ratio of the clustered to the binomial variance.
[[nodiscard]] std::optional<Contradiction> below_chance(std::span<const Level> levels, double probability);

/// Same for a fit with the verdict step. Permitted are the proportions between the fitted function and the infinitely
/// steep function with the same threshold, on both sides of it. Also empty without threshold or slope.
[[nodiscard]] std::optional<Contradiction> contradicts_step(std::span<const Level> levels, const PsychometricFit& fit,
                                                            PsychometricForm form, double probability);

}  // namespace todbench
