// Camera against twin by common phases: both answered the same presentations, and what those have in common cancels.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "acquisition/core/result.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/contrast_slope.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// What is beside a paired ratio wherever people read it. `measured_once`: has_contrast_measured_once().
[[nodiscard]] std::string not_cancelled_by_pairs(bool measured_once);

/// One presentation of one triangle: what the camera's frames were answered with, and what the twin's were.
struct PairedAnswer {
  GradedAnswer camera;
  double twin_probability = 0;  ///< of the right answer, mean over the twin's draws
  double twin_variance = 0;     ///< of that mean, from the scatter of the draws
};

/// Difference estimator of the ratio of acuities camera / twin: ln S75 of both by quasi-likelihood with the same
/// function `table` (twin_shape.h; with a slope of their own, both, where `with_slope`), their difference, and its
/// variance from the differences of what each answer has in the two, over set-ups or over presentations and places
/// (clustered_variance.h). To first order an error of the function is in neither, and what camera and twin have in
/// common, the phase of a presentation, is in neither the difference nor its interval. Noise that they share
/// would cancel as well: the caller sees to it that they share none.
///
/// The twin is shown the contrast that the camera measured once in each set-up. Over set-ups its scatter is in the
/// differences; what all set-ups have in common of it (`contrast.shared_se_ln_acuity`) is added. Presentations and
/// places do not see that scatter, and then all of `contrast.se_ln_acuity` is.
///
/// `draws` is kept for the record. Verdict as of compare(), with Student's t; equivalent wins. `invalid_input`: as
/// twin_shape_estimate(), fewer than two clusters, a margin that is not positive, probabilities outside 0 to 1.
[[nodiscard]] Result<RatioOfPairs> paired_ratio(std::span<const PairedAnswer> answers, const ProportionTable& table,
                                                bool with_slope, int draws, double margin_percent,
                                                const ContrastScatter& contrast = {});

/// The ratio A / B of two cameras from the ratios of both to the same twin, each with its own presentations, whose
/// errors are independent: degrees of freedom of Welch and Satterthwaite. `draws` is the smaller one.
[[nodiscard]] RatioOfPairs ratio_of_paired(const RatioOfPairs& a, const RatioOfPairs& b, double margin_percent);

}  // namespace todbench
