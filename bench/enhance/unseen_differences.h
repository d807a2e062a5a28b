// SPDX-License-Identifier: GPL-3.0-or-later
// Bound of a ratio that few or no differing answers show.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "tod/presentation/trial.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Answers of two runs to the same triangles at one contrast, in the presentations that both contain.
struct PairedAnswers {
  std::size_t count = 0, differing = 0;  ///< differing: right in one run only
  /// Every answer and every score of the observer is the same bit for bit: it judged equal pictures, and a ratio is
  /// exact. False if the observer gives no scores.
  bool identical = false;
};
[[nodiscard]] PairedAnswers paired_answers(std::span<const Trial> with, std::span<const Trial> without,
                                           double set_delta_t_k);

/// Below this number of differing answers the interval of the jackknife is too short above.
inline constexpr std::size_t enough_differing = 10;

/// Returns how much larger than its estimate |ln ratio| of the thresholds may be (95 %) with so few differing answers.
/// A shift D of ln S75 changes the proportion of correct answers at each size by D psi'(ln size), so that a share of at
/// least D times the mean of psi' over the answers differs. If k of n differ, the share is at most q (Clopper and
/// Pearson 1934; 1 - 0.025^(1/n) for k = 0), which is q - k / n above the share that the estimate shows: D is at most
/// (q - k / n) / mean psi' above it. Answers count as independent. `fit`: of the run without, in this form. Empty: no
/// slope, or no size near the threshold.
[[nodiscard]] std::optional<double> unseen_ln_ratio(const PairedAnswers& answers, std::span<const Trial> without,
                                                    double set_delta_t_k, const PsychometricFit& fit,
                                                    PsychometricForm form);

}  // namespace todbench
