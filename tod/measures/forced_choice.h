// SPDX-License-Identifier: GPL-3.0-or-later
// Threshold of a person from right and wrong answers at contrasts of both polarities, two alternatives each.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "acquisition/base/interval.h"

namespace todbench {

/// One answer of a person who chose between two intervals.
struct ForcedChoice {
  double contrast_k = 0;  ///< signed, as the target reported it; not 0
  int set_up = 0;         ///< place of the plate between the pixels
  bool right = false;
};

/// Threshold of one person for one target.
struct ForcedChoiceThreshold {
  std::optional<double> positive_k{}, negative_k{};  ///< contrast for 75 % correct; the negative one is below 0
  std::optional<double> half_k{};                    ///< half of their difference
  Interval ci95{};                                   ///< of half_k
  std::map<int, double> half_k_without{};            ///< half_k without the answers of one set-up, by set-up
  double lapse = 0;                                  ///< share of answers given without regard to the picture
  int answers = 0, right = 0;
  std::string reason{};  ///< of a missing threshold; empty if there is one
};

/// Variance of ln of a value by jackknife over parts of the data, such as set-ups, from the values without each part.
/// Precondition: all values above 0.
[[nodiscard]] double jackknife_variance_of_ln(const std::map<int, double>& without);

/// Fewest answers at each polarity, and fewest set-ups, of a threshold.
inline constexpr int least_choices = 24, least_choice_set_ups = 5;

/// Fits 0.5 l + (1 - l) Phi(0.674 (c / t)^b) to the answers: the function that is fitted to the model's answers
/// (two_intervals.h), with one exponent b (0.5 to 6) for both polarities and a share l of lapses (0 to 0.06), because a
/// person lapses. At each of 36 pairs of b and l, ln t of each polarity is fitted by maximum likelihood; the result is
/// the mean over the pairs, weighted by the likelihood. t is a threshold without lapses, as for the model. The half
/// difference does not contain the offset of the target.
///
/// The interval is that of the jackknife over the set-ups, with Student's t, for ln half_k. Its variance is at least
/// that of independent answers: the observed information at each pair, and the scatter between the pairs. A missing
/// threshold has a reason: too few answers or set-ups, answers that do not differ from guessing (p > 0.001), or a
/// threshold outside the contrasts shown.
[[nodiscard]] ForcedChoiceThreshold forced_choice_threshold(std::span<const ForcedChoice> answers);

}  // namespace todbench
