// What a design can show before a trial is made: the uncertainty to expect, and whether a comparison can succeed.
#pragma once

#include <span>
#include <vector>

#include "acquisition/core/result.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// How often a size will be shown, and how often the answer is expected to be right.
struct PlannedLevel {
  double size = 0;                ///< > 0, any unit
  double trials = 0;              ///< >= 0, need not be whole
  double proportion_correct = 0;  ///< in [0, 1]
};

/// What the expected answers would come to: the fit to counts that equal their expectation, its uncertainty that of
/// `trials`. Clusters are not known beforehand: trials count as independent.
struct ExpectedFit {
  double threshold = 0, slope = 0, trials = 0;
  double se_ln_threshold = 0;  ///< from the information of the expected counts
};
/// Errors: `invalid_input` (a level out of range, or expected answers without a threshold, with the verdict in words).
[[nodiscard]] Result<ExpectedFit> expected_fit(std::span<const PlannedLevel> design, const FitOptions& options);

/// The design with its trials at sizes of a psychometric function: proportions filled in.
[[nodiscard]] std::vector<PlannedLevel> design_at(std::span<const Level> totals, PsychometricForm form,
                                                  double threshold, double slope, double lapse);

/// Probability that two one-sided tests at 5 % find two acuities equivalent within `margin_percent` (the ratio inside
/// [1/(1+m), 1+m]) when the logarithm of their ratio is estimated with standard error `se_ln_ratio` > 0, and is
/// `true_ln_ratio` in truth. Normal theory (Schuirmann 1987): exact for normal estimates, 0 where the 90 % interval is
/// wider than the margin.
[[nodiscard]] double equivalence_power(double se_ln_ratio, double margin_percent, double true_ln_ratio);

/// One contrast of a comparison that has not been made.
struct PlannedComparison {
  double delta_t_k = 0;
  double se_ln_a = 0, se_ln_b = 0;    ///< expected, of both thresholds
  double trials_a = 0, trials_b = 0;  ///< per contrast
  [[nodiscard]] double se_ln_ratio() const;
};

/// What a comparison over several contrasts can show.
struct ComparisonOutlook {
  double margin_percent = 0;
  double power = 0;  ///< that every contrast is found equivalent, contrasts independent
  /// By which all trial numbers have to be multiplied for a power of 80 %; at or below 1 the plan suffices.
  double trials_factor = 0;
  double trials_needed_a = 0;  ///< of A per contrast, the largest over contrasts, rounded up
  [[nodiscard]] bool reaches_80_percent() const { return power >= 0.8; }
};
/// At least one contrast, standard errors > 0.
[[nodiscard]] ComparisonOutlook comparison_outlook(std::span<const PlannedComparison> contrasts, double margin_percent);

}  // namespace todbench
