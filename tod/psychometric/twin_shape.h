// SPDX-License-Identifier: GPL-3.0-or-later
// Fits answers with the function of a simulated twin instead of a Weibull function. The function is the direct estimate
// of the twin, stretched in ln size.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// A table as a smooth, increasing function of ln size. Immutable, cheap to copy.
class TwinShape {
 public:
  /// Creates the function from ln((P - 1/4) / (1 - P)), P being a proportion of the table. It is nearly linear in ln
  /// size. These values are smoothed by local parabolas through seven nodes, weighted by their standard errors. The
  /// smoothed values are made increasing and joined by monotone cubics (Fritsch and Carlson 1980). Usable nodes are
  /// those at which P differs significantly from chance level and from 1. Outside these nodes, the function is a
  /// straight line. Errors: `invalid_input` (sizes that do not increase, proportions outside 0 to 1, fewer than five
  /// usable nodes, or no usable node on one side of 75 %).
  [[nodiscard]] static Result<TwinShape> of(const ProportionTable& table);

  struct Value {
    double proportion = 0;
    double derivative = 0;  ///< derivative per unit of ln size
  };
  /// Returns the value at ln(size / mrad).
  [[nodiscard]] Value at(double ln_size) const;
  /// Returns ln of the size at 75 %.
  [[nodiscard]] double ln_threshold() const { return ln_threshold_; }
  /// Returns ln of the size with this proportion, within the sizes of the table.
  [[nodiscard]] double ln_size_at(double proportion) const;
  /// Returns the proportion at the largest size in use.
  [[nodiscard]] double largest_proportion() const;

 private:
  struct Curve;
  std::shared_ptr<const Curve> curve_;
  double ln_threshold_ = 0;
};

/// Returns the proportion of correct answers at ln(size / mrad), for a camera whose function is `use`, with a lapse.
[[nodiscard]] double twin_proportion(const TwinShape& shape, const TwinShapeUse& use, double lapse, double ln_size);

/// Fits the answers again with the function of the twin. The fitted parameter is the ratio of sizes. A second
/// parameter, the ratio of slopes at 75 %, is added if the answers require it (t test, 1 %). A lapse l changes a
/// proportion P of the twin to 1/4 + (3/4 - l) (P - 1/4) / (3/4). A free lapse (`options.fixed_lapse` empty) is a
/// further parameter from 0 to 0.1. S75 is the size at 75 % with the lapse. `weibull` is the fit of the same answers by
/// the Weibull function of `options`. If `weibull` has no regular maximum (verdict other than ok and extrapolated), it
/// is returned unchanged.
///
/// The fit is by quasi-likelihood, as in fit_graded(). Binary answers have probabilities of 1 and 0, and binomial
/// scatter (clustered_variance.h). Intervals are symmetric in ln threshold. The half-width is Student's t times the
/// root of the sum of two variances: that of the answers, and that due to the standard errors of the table. `slope` is
/// the slope of the Weibull function of `options.form` with the same derivative at 75 %. Binary answers have a
/// deviance. Errors: `invalid_input` (as TwinShape::of(), and a fixed lapse with which the table does not reach 75 %).
[[nodiscard]] Result<PsychometricFit> fit_twin_shape(std::span<const GradedAnswer> answers,
                                                     const PsychometricFit& weibull, const ProportionTable& table,
                                                     const FitOptions& options);

/// Fits the answers of `fit` (from fit_twin_shape(), with a fixed lapse) again with a free lapse and the same number of
/// other parameters, as a check. Error: `invalid_input` (a fit without a function of a twin).
[[nodiscard]] Result<PsychometricFit> twin_fit_with_free_lapse(std::span<const GradedAnswer> answers,
                                                               const PsychometricFit& fit, PsychometricForm form);

/// Returns the gain in twice the ln quasi-likelihood by a free lapse, divided by the variance inflation of the lapse.
/// The gain is 0 if the free lapse is not larger than the lapse of `fit`. Both fits use the function of the twin.
[[nodiscard]] double twin_lapse_gain(const PsychometricFit& fit, const PsychometricFit& free_fit);

/// ln threshold from graded answers according to the function of a twin, and the contribution of each answer.
struct ShapeEstimate {
  double ln_threshold = 0;
  /// One value per answer; the sum of the squares is the information about ln threshold.
  std::vector<double> direction;
  std::vector<double> weight;     ///< for each answer, change of ln threshold per unit of its probability
  std::vector<double> influence;  ///< for each answer, weight times (probability minus mean)
};

/// Computes the quasi-likelihood estimate of fit_twin_shape(), with one parameter, or two if `with_slope`. Answers
/// without a size have no influence. Errors: `invalid_input` (as TwinShape::of(), and answers without information about
/// the threshold).
[[nodiscard]] Result<ShapeEstimate> twin_shape_estimate(std::span<const GradedAnswer> answers,
                                                        const ProportionTable& table, bool with_slope);

}  // namespace todbench
