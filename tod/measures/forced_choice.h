// SPDX-License-Identifier: GPL-3.0-or-later
// Threshold of a person from binary answers to pairs of intervals, at contrasts of both polarities.
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
  bool right = false;     ///< the answer is correct
};

/// Threshold of one person for one target.
struct ForcedChoiceThreshold {
  std::optional<double> positive_k{}, negative_k{};  ///< contrasts for 75 % correct answers; the contrast of negative
                                                     ///< polarity is below 0
  std::optional<double> half_k{};                    ///< half of (positive_k - negative_k)
  Interval ci95{};                                   ///< interval of half_k
  std::map<int, double> half_k_without{};            ///< half_k without the answers of one set-up; key: this set-up
  double lapse = 0;                                  ///< share of answers that do not depend on the picture
  int answers = 0, right = 0;
  std::string reason{};  ///< reason for a missing threshold; empty if there is one
};

/// Returns the variance of the logarithm of a value by jackknife over parts of the data, for example over set-ups.
/// `without`: values computed without one part of the data; key: this part. Precondition: all values above 0.
[[nodiscard]] double jackknife_variance_of_ln(const std::map<int, double>& without);

/// Minimum number of answers at each polarity, and minimum number of set-ups, for a threshold.
inline constexpr int least_choices = 24, least_choice_set_ups = 5;

/// Fits the probability of a correct answer at contrast c, 0.5 l + (1 - l) Phi(0.674 (c / t)^b), to the answers. This
/// function differs from that for the answers of the model (two_intervals.h) in two ways. The exponent b (0.5 to 6) is
/// common to both polarities. A share l of lapses (0 to 0.06) is fitted, because a person makes errors that do not
/// depend on the picture. At each of 36 pairs of b and l, ln t of each polarity is fitted by maximum likelihood. The
/// result is the mean over the pairs, weighted by the likelihood. t is a threshold without lapses, as for the model. In
/// half of the difference of the two thresholds, the offset of the target cancels.
///
/// The interval of ln half_k is computed by jackknife over the set-ups, with Student's t. Its variance is at least the
/// variance of independent answers, which is computed from the observed information at each pair and from the scatter
/// between the pairs. There is no threshold in three cases: too few answers or set-ups, answers that do not differ from
/// guessing (p > 0.001), or a threshold outside the presented contrasts.
[[nodiscard]] ForcedChoiceThreshold forced_choice_threshold(std::span<const ForcedChoice> answers);

}  // namespace todbench
