// SPDX-License-Identifier: GPL-3.0-or-later
// Tests whether the answers of a person agree with a fitted observer.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <stop_token>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/observer_fit/person_fit.h"

namespace todbench {

/// Test statistics. A large value is evidence against the model.
enum class MisfitKind {
  contrast_and_size,  ///< number of correct answers by contrast and size: sum of (observed - expected)^2 / variance
  confusion,          ///< this sum for the number of answers, by direction of the triangle and by answered direction
  calibration,        ///< this sum for the number of correct answers, over groups of patches with similar predicted
                      ///< probability
  /// (s - expectation of s)^2 / variance of s, where s is the sum of -ln p over the answers, and p is the probability
  /// of the chosen alternative according to the model.
  surprise,
  /// As surprise, but only for wrong answers. In this case p is the probability of the chosen alternative, given that
  /// the answer is wrong.
  wrong_answers,
};
inline constexpr std::array all_misfit_kinds{MisfitKind::contrast_and_size, MisfitKind::confusion,
                                             MisfitKind::calibration, MisfitKind::surprise, MisfitKind::wrong_answers};
[[nodiscard]] std::string_view to_string(MisfitKind kind);

/// One test of the fitted model.
struct MisfitTest {
  double statistic = 0;
  double expected = 0;  ///< mean over the replicates
  /// P value from a scaled chi-squared distribution with the mean and the variance of the replicates (Satterthwaite
  /// 1946).
  double p = 1;
};

/// Answers at one contrast and size.
struct AnswerCell {
  int cell = 0;  ///< PersonAnswer::cell
  double answers = 0, correct = 0;
  double expected = 0, sd = 0;  ///< expectation and sd of the number of correct answers under the fitted model
};

/// Result of goodness_of().
struct Goodness {
  std::array<MisfitTest, all_misfit_kinds.size()> tests{};  ///< one test for each MisfitKind
  /// Result of the joint test: share of replicates of the fitted model whose smallest p is at most the smallest
  /// observed p.
  double p = 1;
  int replicates = 0;
  std::vector<AnswerCell> cells;
  std::array<std::array<double, 4>, 4> confusion{}, expected_confusion{};  ///< [truth][answer]
};

/// Options of goodness_of().
struct GoodnessOptions {
  int replicates = 299;  ///< number of bootstrap replicates, at least 19
  std::uint64_t seed = 1;
};

/// Tests a fit by parametric bootstrap. In each replicate, the fitted model answers the same patches, and the model is
/// fitted to these answers. The distribution of every statistic is computed from the replicates. Errors: `interrupted`.
[[nodiscard]] Result<Goodness> goodness_of(AnswerLattice& lattice, std::span<const PersonAnswer> answers,
                                           const PersonFit& fit, const GoodnessOptions& options, std::stop_token stop);

}  // namespace todbench
