// SPDX-License-Identifier: GPL-3.0-or-later
// Expected uncertainty of a design, and the probability that a comparison succeeds.
#pragma once

#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Number of trials at a size, and expected share of correct answers at this size.
struct PlannedLevel {
  double size = 0;                ///< > 0, any unit
  double trials = 0;              ///< >= 0, may be fractional
  double proportion_correct = 0;  ///< expected share of correct answers, in [0, 1]
};

/// Expected result of a design: the fit to the expected counts, and its uncertainty for this number of trials. Assumes
/// independent trials, because clusters are not known beforehand.
struct ExpectedFit {
  double threshold = 0, slope = 0, trials = 0;
  double se_ln_threshold = 0;  ///< standard error from the information of the expected counts
};
/// Fits the expected counts. Errors: `invalid_input` (a level out of range; or the expected answers have no threshold:
/// the message then contains the verdict of the fit).
[[nodiscard]] Result<ExpectedFit> expected_fit(std::span<const PlannedLevel> design, const FitOptions& options);

/// Returns the design with sizes and trials of `totals` and the proportions of a psychometric function.
[[nodiscard]] std::vector<PlannedLevel> design_at(std::span<const Level> totals, PsychometricForm form,
                                                  double threshold, double slope, double lapse);

/// Returns the probability that two one-sided tests at 5 % find two acuities equivalent within `margin_percent` (ratio
/// inside [1/(1+m), 1+m]). `true_ln_ratio`: true value of the logarithm of their ratio; `se_ln_ratio` > 0: standard
/// error of the estimate of this logarithm. The result is exact for normally distributed estimates (Schuirmann 1987).
/// The probability is 0 if the 90 % interval is wider than the margin.
[[nodiscard]] double equivalence_power(double se_ln_ratio, double margin_percent, double true_ln_ratio);

/// One contrast of a planned comparison.
struct PlannedComparison {
  double delta_t_k = 0;
  double se_ln_a = 0, se_ln_b = 0;    ///< expected standard errors of both thresholds
  double trials_a = 0, trials_b = 0;  ///< numbers of trials per contrast
  [[nodiscard]] double se_ln_ratio() const;
};

/// Expected success of a comparison over several contrasts.
struct ComparisonOutlook {
  double margin_percent = 0;
  double power = 0;  ///< probability that every contrast is found equivalent, for independent contrasts
  /// Factor by which all numbers of trials must be multiplied for a power of 80 %. If it is at most 1, the plan is
  /// sufficient.
  double trials_factor = 0;
  /// Trials of A per contrast for a power of 80 %, largest value over the contrasts, rounded up.
  double trials_needed_a = 0;
  [[nodiscard]] bool reaches_80_percent() const { return power >= 0.8; }
};
/// Computes the expected success. Precondition: at least one contrast, standard errors > 0.
[[nodiscard]] ComparisonOutlook comparison_outlook(std::span<const PlannedComparison> contrasts, double margin_percent);

}  // namespace todbench
