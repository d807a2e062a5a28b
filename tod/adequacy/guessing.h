// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the answers could come from guessing.
#pragma once

#include <span>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Largest probability of guessing at which a threshold is fit for a decision. The value corresponds to the 95 %
/// interval.
inline constexpr double false_alarms_of_guessing = 0.05;

/// Returns an upper bound, at most 1, of the probability that guessing yields at least the observed number of correct
/// answers at the largest sizes. A guess is correct with probability 1/4. The probability is computed for every
/// possible number of included sizes; the lowest value, multiplied by the number of these choices (Bonferroni), is
/// returned. Returns 1 without answers at a positive size. The counts must be those of binary answers.
[[nodiscard]] double p_guessed(std::span<const Level> levels);

}  // namespace todbench
