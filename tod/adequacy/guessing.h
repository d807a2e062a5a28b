// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the answers could come from guessing.
#pragma once

#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Largest probability of guessing at which a threshold is fit for a decision (matches the 95 % interval).
inline constexpr double false_alarms_of_guessing = 0.05;

/// Returns an upper bound, at most 1, of the probability that guessing yields at least the observed number of correct
/// answers at the largest sizes. A guess is correct with probability 1/4. The number of included sizes is chosen so
/// that the probability is lowest, and the result is multiplied by the number of choices (Bonferroni). Returns 1
/// without answers at a positive size. For counts of binary answers.
[[nodiscard]] double p_guessed(std::span<const Level> levels);

}  // namespace todbench
