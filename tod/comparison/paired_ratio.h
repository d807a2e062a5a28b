// SPDX-License-Identifier: GPL-3.0-or-later
// Ratio of camera and twin from common phases: both answered the same presentations, so their common variation cancels.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "acquisition/base/result.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Returns the sentence about the errors that do not cancel, for reports with a paired ratio. `measured_once`: result
/// of has_contrast_measured_once().
[[nodiscard]] std::string not_cancelled_by_pairs(bool measured_once);

/// One presentation of one triangle: the answer to the camera's frames and the twin's answers.
struct PairedAnswer {
  GradedAnswer camera;
  double twin_probability = 0;  ///< probability of the correct answer, mean over the twin's draws
  double twin_variance = 0;     ///< variance of that mean, from the scatter of the draws
};

/// Function for the twin's answers if the camera's function differs, or may differ, from the twin's function. The
/// errors of two different functions do not cancel; they are added.
struct OwnFunctions {
  const ProportionTable& twin;
  double variance = 0;      ///< variance of ln S75, from both functions
  bool with_slope = false;  ///< whether the twin's fit has its own slope
};

/// Computes the difference estimator of the ratio of acuities camera / twin. ln S75 of both is fitted by
/// quasi-likelihood with the same function `table` (twin_shape.h), each with its own slope if `with_slope`. The
/// variance of the difference of both comes from the differences of each answer's contributions, over set-ups or over
/// presentations and places (clustered_variance.h). To first order, two errors appear neither in the difference nor in
/// its interval: the error of the function, and the variation common to camera and twin (the phase of a presentation).
/// Precondition: camera and twin share no noise, because common noise would cancel as well.
///
/// The twin is shown the contrast that the camera measured once in each set-up. Over set-ups, the differences contain
/// the scatter of this contrast; its part common to all set-ups (`contrast.shared_se_ln_acuity`) is added. The variance
/// over presentations and places does not contain this scatter, so the whole `contrast.se_ln_acuity` is added.
///
/// `draws` is stored in the result. Verdict as in compare(), with Student's t; equivalent has priority. Errors:
/// `invalid_input` (as twin_shape_estimate(), fewer than two clusters, a margin that is not positive, probabilities
/// outside 0 to 1).
[[nodiscard]] Result<RatioOfPairs> paired_ratio(std::span<const PairedAnswer> answers, const ProportionTable& table,
                                                bool with_slope, int draws, double margin_percent,
                                                const ContrastScatter& contrast = {},
                                                const std::optional<OwnFunctions>& own = std::nullopt);

/// Returns the ratio A / B of two cameras from the ratios of both to the same twin. Each ratio has its own
/// presentations and independent errors; degrees of freedom of Welch and Satterthwaite. `draws` is the smaller one.
[[nodiscard]] RatioOfPairs ratio_of_paired(const RatioOfPairs& a, const RatioOfPairs& b, double margin_percent);

}  // namespace todbench
