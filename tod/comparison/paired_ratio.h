// SPDX-License-Identifier: GPL-3.0-or-later
// Ratio of the acuities of camera and twin from the same presentations. Camera and twin have the same phases, so the
// variation with the phase cancels.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "acquisition/base/result.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Returns a sentence for reports with a paired ratio. The sentence states the errors that do not cancel.
/// `measured_once`: result of has_contrast_measured_once().
[[nodiscard]] std::string not_cancelled_by_pairs(bool measured_once);

/// One presentation of one triangle: the answer to the camera's frames and the twin's answers.
struct PairedAnswer {
  GradedAnswer camera;
  double twin_probability = 0;  ///< probability of the correct answer, mean over the twin's draws
  double twin_variance = 0;     ///< variance of that mean, from the scatter of the draws
};

/// Function for the answers of the twin, if the function of the camera differs or may differ from that of the twin. The
/// errors of different functions do not cancel, so they are added.
struct OwnFunctions {
  const ProportionTable& twin;
  double variance = 0;      ///< variance of ln S75 due to both functions
  bool with_slope = false;  ///< true: the slope of the twin is fitted separately
};

/// Estimates the ratio of acuities camera / twin from the difference of ln S75. The values of ln S75 of camera and twin
/// are fitted by quasi-likelihood with the same function `table` (twin_shape.h), with separate slopes if `with_slope`.
/// For each answer, the contributions to the two values are subtracted. The variance of these differences over set-ups,
/// or over presentations and positions, is the variance of the result (clustered_variance.h). To first order, two
/// errors have no effect on the difference and on its interval: the error of the function, and the variation common to
/// camera and twin (the phase of a presentation). Precondition: camera and twin have independent noise, because common
/// noise would also cancel.
///
/// The twin is simulated at the contrast that the camera measured once in each set-up. The variance over set-ups
/// therefore contains the scatter of this contrast, except for the part common to all set-ups. This part
/// (`contrast.shared_se_ln_acuity`) is added. The variance over presentations and positions does not contain this
/// scatter, so the whole scatter (`contrast.se_ln_acuity`) is added.
///
/// `draws` is stored in the result. The verdict is that of compare(), with Student's t. Errors: `invalid_input` (as
/// twin_shape_estimate(), fewer than two clusters, a margin that is not positive, probabilities outside 0 to 1).
[[nodiscard]] Result<RatioOfPairs> paired_ratio(std::span<const PairedAnswer> answers, const ProportionTable& table,
                                                bool with_slope, int draws, double margin_percent,
                                                const ContrastScatter& contrast = {},
                                                const std::optional<OwnFunctions>& own = std::nullopt);

/// Returns the ratio A / B of two cameras from the ratios of both cameras to the same twin. Precondition: the ratios
/// come from different presentations, so their errors are independent. The degrees of freedom are those of Welch and
/// Satterthwaite. `draws` of the result is the smaller of the two values.
[[nodiscard]] RatioOfPairs ratio_of_paired(const RatioOfPairs& a, const RatioOfPairs& b, double margin_percent);

}  // namespace todbench
