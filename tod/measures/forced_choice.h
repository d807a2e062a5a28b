// SPDX-License-Identifier: GPL-3.0-or-later
// Threshold of a person from correct and wrong answers at contrasts of both polarities, with two alternatives each.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>

#include "acquisition/base/interval.h"

namespace todbench {

/// One answer of a person who chose between two intervals.
struct ForcedChoice {
  double contrast_k = 0;  ///< signed, as reported by the target; not 0
  int set_up = 0;         ///< position of the plate relative to the pixels
  bool right = false;
};

/// Threshold of one person for one target.
struct ForcedChoiceThreshold {
  std::optional<double> positive_k{}, negative_k{};  ///< contrast for 75 % correct answers; the negative one is below 0
  std::optional<double> half_k{};                    ///< half of their difference
  Interval ci95{};                                   ///< interval of half_k
  std::map<int, double> half_k_without{};            ///< half_k if the answers of one set-up are left out, by set-up
  double lapse = 0;                                  ///< share of answers that do not depend on the picture
  int answers = 0, right = 0;
  std::string reason{};  ///< reason for a missing threshold; empty if there is one
};

/// Returns the variance of ln of a value by jackknife over parts of the data, such as set-ups. `without`: the values
/// without each part. Precondition: all values above 0.
[[nodiscard]] double jackknife_variance_of_ln(const std::map<int, double>& without);

/// Minimum number of answers at each polarity, and minimum number of set-ups, for a threshold.
inline constexpr int least_choices = 24, least_choice_set_ups = 5;

/// Fits 0.5 l + (1 - l) Phi(0.674 (c / t)^b) to the answers. The same function is fitted to the model's answers
/// (two_intervals.h), but with one exponent b (0.5 to 6) for both polarities and, because a person lapses, a share l of
/// lapses (0 to 0.06). At each of 36 pairs of b and l, ln t of each polarity is fitted by maximum likelihood; the
/// result is the mean over the pairs, weighted by the likelihood. t is a threshold without lapses, as for the model.
/// The half difference does not contain the offset of the target.
///
/// The interval for ln half_k comes from the jackknife over the set-ups, with Student's t. Its variance is at least
/// that of independent answers: the observed information at each pair plus the scatter between the pairs. If there is
/// no threshold, the reason is one of these: too few answers or set-ups, answers that do not differ from guessing (p >
/// 0.001), or a threshold outside the presented contrasts.
[[nodiscard]] ForcedChoiceThreshold forced_choice_threshold(std::span<const ForcedChoice> answers);

}  // namespace todbench
