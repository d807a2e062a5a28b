// SPDX-License-Identifier: GPL-3.0-or-later
// Fit of one psychometric function to counts of correct answers, with intervals and a verdict.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Answers at one size (or contrast). Counts have the type double, to allow 2e9 trials and to detect non-integer
/// counts.
struct Level {
  double size = 0;     ///< >= 0; 0 is a catch trial (no triangle)
  double correct = 0;  ///< integer, 0 <= correct <= total; for graded answers the sum of their probabilities
  double total = 0;    ///< integer; 0: the level is ignored
  /// Index of the cluster: trials with a common phase, frame or fixed pattern; < 0: independent trials.
  int cluster = -1;
};

/// One graded answer: the probability of the correct answer to the patch.
struct GradedAnswer {
  double size = 0;                 ///< > 0
  double probability_correct = 0;  ///< 0 to 1
  /// Index of the presentation, at least 0; answers of one presentation have the same frame and phase.
  int presentation = 0;
  /// Index of the place in the picture, at least 0; answers of one place have the same detectors and fixed pattern.
  int place = 0;
  int set_up = 0;  ///< index of plate and mounting of the presentation, at least 0
};

/// Form of the function psi of the size x: a Weibull function with chance level g = 0.25, lapse l, scale a and slope b.
/// At the threshold psi is 0.75.
enum class PsychometricForm {
  size,    ///< psi = g + (1-g-l)(1 - exp(-(x/a)^b)), increasing in size
  acuity,  ///< psi = g + (1-g-l) exp(-(a/x)^b): a Weibull in acuity 1/x, the form attributed to TNO
};
[[nodiscard]] std::string_view to_string(PsychometricForm form);

/// Verdict on a fit. Each verdict is defined by a condition on the likelihood. If several conditions are met, the first
/// verdict of this list is used.
enum class FitVerdict {
  no_data,  ///< no trials at a positive size
  /// Supremum of the likelihood at chance level for all sizes: only a lower limit of the threshold exists.
  above_range,
  below_range,           ///< supremum of the likelihood at threshold -> 0: only an upper limit of the threshold exists
  slope_unidentifiable,  ///< answers at only one positive size
  step,                  ///< no finite slope maximises the likelihood, or only one level is informative
  flat_or_decreasing,    ///< slope at its lower limit: the threshold is meaningless
  underdetermined,       ///< more parameters than positive sizes
  extrapolated,          ///< threshold outside the tested sizes
  ok,
};
[[nodiscard]] std::string_view to_string(FitVerdict verdict);

/// Options of a fit.
struct FitOptions {
  PsychometricForm form = PsychometricForm::size;
  std::optional<double> fixed_lapse = 0.0;  ///< fixed lapse; empty: free in [0, 0.1]
  bool with_posterior = true;
  bool graded = false;  ///< levels contain graded answers: their counts may be fractional
};

/// Posterior distribution of the threshold.
struct Posterior {
  double median = 0;
  double low = 0, high = 0;  ///< limits of the equal-tailed 95 % interval
  /// True if the marginal density at a limit of the prior is above 1 % of its maximum. In this case the prior, not the
  /// data, determines the result.
  bool prior_bound = false;
};

/// Basis of the intervals.
enum class IntervalKind {
  independent,  ///< profile likelihood of independent answers
  clusters,     ///< profile likelihood, widened for the variation common to the trials of a cluster
  two_way,      ///< quasi-likelihood, with the variance of the answers over presentations and positions
  set_ups,      ///< quasi-likelihood, with the variance of the answers over plates and mountings
};
inline constexpr std::array all_interval_kinds{IntervalKind::independent, IntervalKind::clusters, IntervalKind::two_way,
                                               IntervalKind::set_ups};
[[nodiscard]] std::string_view to_string(IntervalKind kind);
/// Returns whether the scatter of the answers was estimated and not assumed to be binomial.
[[nodiscard]] constexpr bool is_quasi(IntervalKind kind) {
  return kind == IntervalKind::two_way || kind == IntervalKind::set_ups;
}

/// Function with which answers are fitted.
enum class FitEstimator {
  weibull,     ///< a Weibull function, in size or in acuity
  twin_shape,  ///< the function of the simulated twin, stretched (twin_shape.h)
};
inline constexpr std::array all_fit_estimators{FitEstimator::weibull, FitEstimator::twin_shape};
[[nodiscard]] std::string_view to_string(FitEstimator estimator);

/// Reason for the choice of the function.
enum class EstimatorReason {
  plan,     ///< the plan states it
  twin,     ///< there is a simulated twin, and its function is used
  no_twin,  ///< there are only counts, without a simulated sensor
  person,   ///< a person answered, and every person has an individual function
  modules,  ///< modules follow the sensor, so the function of the sensor alone does not describe the chain
  /// An enhancement package follows the sensor, so the function of the sensor alone does not describe the chain.
  package,
  moving_target,  ///< the twin's function is only valid for a target at rest
  irregular,      ///< the Weibull fit has no usable threshold (verdict)
  no_function,    ///< the twin has no usable function at this contrast
  ended_early,    ///< the run ended before its functions were available
};
inline constexpr std::array all_estimator_reasons{EstimatorReason::plan,          EstimatorReason::twin,
                                                  EstimatorReason::no_twin,       EstimatorReason::person,
                                                  EstimatorReason::modules,       EstimatorReason::package,
                                                  EstimatorReason::moving_target, EstimatorReason::irregular,
                                                  EstimatorReason::no_function,   EstimatorReason::ended_early};
[[nodiscard]] std::string_view to_string(EstimatorReason reason);
/// Returns the reason as a part of a sentence, for example "there is a simulated twin".
[[nodiscard]] std::string_view in_words(EstimatorReason reason);

/// Proportion correct of a simulated sensor as a function of size, without an assumed form, averaged over phases and
/// noise.
struct ProportionTable {
  std::vector<double> size_mrad;           ///< increasing
  std::vector<double> proportion_correct;  ///< proportion of correct answers at each size
  std::vector<double> standard_error;      ///< standard error of each proportion
  bool operator==(const ProportionTable&) const = default;
};

/// Result of a fit with the function of a twin (twin_shape.h).
struct TwinShapeUse {
  double size_ratio = 1;      ///< size at 75 % of these answers divided by that of the twin
  double slope_ratio = 1;     ///< slope at 75 % of these answers divided by that of the twin
  bool slope_fitted = false;  ///< true: slope_ratio was fitted, because the answers required it
  /// Student's t of an additional parameter. The parameter is the slope, or a bend if the slope was fitted.
  double departure = 0;
  double departure_limit = 0;        ///< limit of |departure|, exceeded by chance in 1 % of fits
  double departure_shift = 0;        ///< change of ln threshold due to the additional parameter
  double shape_se_ln_threshold = 0;  ///< contribution of the standard errors of the table
  /// For a free lapse, clustered variance of the lapse divided by its variance for independent answers.
  double lapse_inflation = 1;
  ProportionTable table;
  bool operator==(const TwinShapeUse&) const = default;
};

/// Result of a fit. A poor fit is not an error: the result states a verdict, and contains an interval only if the
/// answers determine the interval.
struct PsychometricFit {
  FitVerdict verdict = FitVerdict::no_data;
  std::optional<double> threshold;  ///< size at which psi = 0.75 exactly
  /// 95 % interval by profile likelihood (drop 3.84). If one side is open, the other side is a one-sided 95 % limit
  /// (drop 2.71).
  Interval ci95;
  Interval ci90;                ///< 90 % interval by profile likelihood (drop 2.71), for equivalence tests
  std::optional<double> slope;  ///< b of PsychometricForm
  /// True if the slope is at the upper limit of its domain, 50. In this case the likelihood increases up to this limit,
  /// and the intervals are computed with slopes within the domain. If the answers form a step whose gap is too narrow
  /// for slopes of the domain, the interval contains the gap.
  bool slope_at_cap = false;
  double lapse = 0;
  std::optional<double> log_likelihood;  ///< ln likelihood without binomial coefficients
  std::optional<double> deviance;
  int degrees_of_freedom = 0;
  std::optional<double> se_ln_threshold;  ///< standard error from the observed information, not widened
  std::optional<Posterior> posterior;
  double trials = 0;
  IntervalKind interval = IntervalKind::independent;
  /// Number of clusters; 0 if trials are independent. For a quasi-likelihood, it is the effective number of clusters:
  /// degrees of freedom of the variance plus one.
  double clusters = 0;
  /// Ratio of the clustered to the independent variance of ln threshold, which ci95 and ci90 already include. Usually
  /// below 1 for graded answers.
  double variance_inflation = 1;
  /// Additional standard uncertainty of ln threshold due to the effective contrast and to an uncertain function. It is
  /// included in ci95 and ci90, but not in variance_inflation.
  double joined_u = 0;
  double contrast_u = 0;  ///< part of joined_u due to the scatter of the effective contrast
  double lag_u = 0;       ///< part of joined_u due to the lag between the triangles while the contrast changes
  /// Ratio of the mean squared residual of graded answers to that of binary answers; empty for binary answers.
  std::optional<double> dispersion;
  /// Result for the function of a twin; empty: a Weibull function was fitted.
  std::optional<TwinShapeUse> twin_shape;

  /// Returns whether the verdict is ok or extrapolated, and ci95 has both limits.
  [[nodiscard]] bool usable() const;
};

/// Returns the function that was fitted.
[[nodiscard]] inline FitEstimator estimator_of(const PsychometricFit& fit) {
  return fit.twin_shape ? FitEstimator::twin_shape : FitEstimator::weibull;
}

/// Returns psi(size) of the model for a threshold, slope and lapse; exact at size 0 and for huge arguments.
[[nodiscard]] double psychometric(PsychometricForm form, double size, double threshold, double slope, double lapse);

/// Fits by maximum likelihood in (ln threshold, ln slope[, lapse]), with a global search followed by Newton steps.
/// Intervals are computed by profile likelihood and from the posterior. Levels may be unsorted, repeated, or single
/// trials. With clusters (Level::cluster >= 0) the intervals are widened by the sandwich variance over clusters and
/// Student's t. With more than 400 different sizes, neighbouring sizes are pooled for the search; the final Newton
/// steps use each size. For 100 000 sizes over a factor of ten, the effect of pooling is less than 1e-4 of the
/// interval. Errors: `invalid_input` (negative, denormal or non-finite size, fractional or negative counts, correct >
/// total, more than 1e12 trials).
[[nodiscard]] Result<PsychometricFit> fit_psychometric(std::span<const Level> levels, const FitOptions& options);

/// Fits the function of fit_psychometric() to graded answers by quasi-likelihood. The mean is that of binary answers,
/// and the variance is proportional to that of binary answers (Wedderburn 1974; McCullagh and Nelder 1989, 9). The
/// profile is scaled by the variance of ln threshold over set-ups, or over presentations and positions
/// (clustered_variance.h), with Student's t. There is no posterior. Errors: `invalid_input` (as fit_psychometric(), and
/// a probability outside 0 to 1).
[[nodiscard]] Result<PsychometricFit> fit_graded(std::span<const GradedAnswer> answers, const FitOptions& options);

}  // namespace todbench
