// SPDX-License-Identifier: GPL-3.0-or-later
// Residuals of answers from a fitted function, and their projections on selected directions of departure.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tod/psychometric/psychometric_likelihood.h"

namespace todbench {

/// Residual at one size.
struct LevelResidual {
  double ln_size = 0;  ///< relative to the reference size; meaningless for catch trials
  double trials = 0;
  double right = 0, wrong = 0;  ///< probabilities of a correct and of a wrong answer according to the function
  double logit = 0;             ///< ln(right / wrong), limited to +-50
  double residual = 0;          ///< correct answers minus their expectation
  bool catch_trials = false;

  /// Returns the variance of the number of correct answers.
  [[nodiscard]] double variance() const { return trials * right * wrong; }
};

/// A fitted function and its residuals.
struct ModelResiduals {
  PooledCounts counts;
  PsychometricForm form = PsychometricForm::size;
  PsychometricPlace place{};
  std::array<bool, 3> fitted{};       ///< parameters that were fitted
  std::vector<LevelResidual> levels;  ///< sizes increasing, catch trials last
};
/// Returns the residuals at the maximum of the likelihood. `fitted`: the parameters that were fitted.
[[nodiscard]] ModelResiduals model_residuals(const PooledCounts& counts, PsychometricForm form,
                                             const PsychometricPlace& place, const std::array<bool, 3>& fitted);

/// Returns ln(psi / (1 - psi)) of a function at every level of the residuals, limited to +-50. Catch trials keep their
/// values.
[[nodiscard]] std::vector<double> logits_at(const ModelResiduals& model, PsychometricForm form,
                                            const PsychometricPlace& place);

/// A departure from the fitted function, orthogonal to its fitted parameters (the efficient score), with unit variance
/// if trials are independent.
struct Direction {
  std::vector<double> weights;  ///< one per level
  double score = 0;             ///< standard normal under the model
};

/// Computes directions from weights of the residuals. A direction is orthogonal to the fitted parameters and to the
/// directions in `besides`. The result is empty if less than a hundredth of the variance of the weights then remains.
class Directions {
 public:
  explicit Directions(const ModelResiduals& model);
  [[nodiscard]] std::optional<Direction> direction(std::vector<double> weights,
                                                   std::span<const Direction> besides = {}) const;

 private:
  [[nodiscard]] double product(const std::vector<double>& a, const std::vector<double>& b) const;

  const ModelResiduals& model_;
  std::vector<std::vector<double>> parameters_;  ///< orthonormal
};

/// Returns the covariance matrix of the scores of directions over clusters, row by row (Liang and Zeger 1986). The
/// matrix contains the factor G / (G - 1), where G is the number of clusters. In levels without a cluster, each trial
/// is a cluster. Precondition: `clusters` > 1.
[[nodiscard]] std::vector<double> cluster_covariance(const ModelResiduals& model, std::span<const Level> levels,
                                                     std::span<const Direction> directions, double clusters);

}  // namespace todbench
