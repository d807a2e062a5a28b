// SPDX-License-Identifier: GPL-3.0-or-later
// Bound on the ratio of two thresholds if few or no answers differ between the runs.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Counts of the answers of two runs to the same triangles at one contrast, in the presentations that both runs
/// contain.
struct PairedAnswers {
  std::size_t count = 0, differing = 0;  ///< differing: correct in one run only
  /// True if all answers and all scores of the observer are equal bit for bit in both runs: the observer judged equal
  /// pictures, and the ratio is exact. False if the observer computes no scores.
  bool identical = false;
};
[[nodiscard]] PairedAnswers paired_answers(std::span<const Trial> with, std::span<const Trial> without,
                                           double set_delta_t_k);

/// Required number of differing answers. With fewer, the upper limit of the jackknife interval is too low.
inline constexpr std::size_t enough_differing = 10;

/// Returns the amount by which |ln ratio| of the thresholds may exceed its estimate (95 %). psi is the psychometric
/// function of the run without the package: `fit`, of form `form`. A shift D of ln S75 changes the share of correct
/// answers at each size by D psi'(ln size). At least the share D mean(psi') of the answers then differs, with the mean
/// over the answers. If k of n answers differ, the true share is at most q (Clopper and Pearson 1934; q = 1 -
/// 0.025^(1/n) for k = 0). The estimate corresponds to the share k / n, so the result is (q - k / n) / mean(psi').
/// Answers count as independent. Empty: no slope, no size near the threshold, all answers differ, or a bound above 3.
[[nodiscard]] std::optional<double> unseen_ln_ratio(const PairedAnswers& answers, std::span<const Trial> without,
                                                    double set_delta_t_k, const PsychometricFit& fit,
                                                    PsychometricForm form);

}  // namespace todbench
