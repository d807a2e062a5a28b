// Answers fitted with the function of a simulated twin in place of a Weibull function: known from its direct estimate,
// stretched in ln size.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// A table as a smooth, rising function of ln size. Immutable, cheap to copy.
class TwinShape {
 public:
  /// ln((P - 1/4) / (1 - P)) is nearly straight in ln size: it is smoothed by local parabolas through seven nodes,
  /// weighted by their standard errors, made rising, and joined by monotone cubics (Fritsch and Carlson 1980); straight
  /// beyond the nodes that tell P from chance and from 1. `invalid_input`: sizes that do not rise, proportions outside
  /// 0 to 1, fewer than five such nodes, or none on one side of 75 %.
  [[nodiscard]] static Result<TwinShape> of(const ProportionTable& table);

  struct Value {
    double proportion = 0;
    double derivative = 0;  ///< per unit of ln size
  };
  /// At ln(size / mrad).
  [[nodiscard]] Value at(double ln_size) const;
  /// ln of the size at 75 %.
  [[nodiscard]] double ln_threshold() const { return ln_threshold_; }
  /// ln of the size with this proportion, within the sizes of the table.
  [[nodiscard]] double ln_size_at(double proportion) const;
  /// That of the largest size in use.
  [[nodiscard]] double largest_proportion() const;

 private:
  struct Curve;
  std::shared_ptr<const Curve> curve_;
  double ln_threshold_ = 0;
};

/// Proportion of right answers of a camera whose function is `use`, with a lapse, at ln(size / mrad).
[[nodiscard]] double twin_proportion(const TwinShape& shape, const TwinShapeUse& use, double lapse, double ln_size);

/// The fit of the same answers with the function of the twin: one parameter, the ratio of sizes, and a second one, the
/// ratio of slopes at 75 %, where the answers ask for it (t test, 1 %). A lapse l makes of a proportion P of the twin
/// 1/4 + (3/4 - l) (P - 1/4) / (3/4); a free one (`options.fixed_lapse` nothing) is a further parameter from 0 to 0.1.
/// S75 is the size at 75 % with the lapse. `weibull` is the fit of the same answers by the Weibull function of
/// `options`; where it has no regular maximum (verdict other than ok and extrapolated) it is returned as it is.
///
/// Quasi-likelihood as fit_graded(); answers that are right or wrong have probabilities of 1 and 0, and the scatter of
/// chance (clustered_variance.h). Intervals are symmetric in ln threshold: Student's t times the root of the variance
/// and of what the standard errors of the table add. `slope` is that of the Weibull function of `options.form` with the
/// same rise at 75 %. Right and wrong answers have a deviance. `invalid_input`: as TwinShape::of(), and a fixed lapse
/// with which the table does not reach 75 %.
[[nodiscard]] Result<PsychometricFit> fit_twin_shape(std::span<const GradedAnswer> answers,
                                                     const PsychometricFit& weibull, const ProportionTable& table,
                                                     const FitOptions& options);

/// The same answers as in `fit` (of fit_twin_shape(), with a fixed lapse) with a free lapse and as many other
/// parameters: a check. `invalid_input`: a fit that has no function of a twin.
[[nodiscard]] Result<PsychometricFit> twin_fit_with_free_lapse(std::span<const GradedAnswer> answers,
                                                               const PsychometricFit& fit, PsychometricForm form);

/// Twice the ln quasi-likelihood by which a free lapse describes the answers better, over its inflation; 0 where it is
/// not larger than that of `fit`. Both are fits with the function of the twin.
[[nodiscard]] double twin_lapse_gain(const PsychometricFit& fit, const PsychometricFit& free_fit);

/// ln threshold from graded answers by the function of a twin, and what each answer has in it.
struct ShapeEstimate {
  double ln_threshold = 0;
  std::vector<double> direction;  ///< by answer: the information on ln threshold is the sum of their squares
  std::vector<double> weight;     ///< by answer: change of ln threshold for each unit of its probability
  std::vector<double> influence;  ///< by answer: weight times what its probability is off its mean
};

/// The quasi-likelihood estimate behind fit_twin_shape(), with one parameter or, `with_slope`, with two. Answers at no
/// size have no influence. `invalid_input`: as TwinShape::of(), and answers that say nothing about the threshold.
[[nodiscard]] Result<ShapeEstimate> twin_shape_estimate(std::span<const GradedAnswer> answers,
                                                        const ProportionTable& table, bool with_slope);

}  // namespace todbench
