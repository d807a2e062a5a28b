// SPDX-License-Identifier: GPL-3.0-or-later
// Likelihood of pooled counts: value, derivatives and closed-form limits.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "acquisition/base/result.h"
#include "tod/psychometric/bounded_newton.h"
#include "tod/psychometric/psychometric_model.h"

namespace todbench {

/// Counts at one positive size after pooling.
struct PooledLevel {
  double ln_size = 0;  ///< ln(size / reference size)
  double right = 0, wrong = 0;

  [[nodiscard]] double total() const { return right + wrong; }
};

/// All data of the likelihood. Equal sizes are pooled. Sizes are sorted, and are relative to a central size, so their
/// unit has no effect.
struct PooledCounts {
  std::vector<PooledLevel> levels;          ///< positive sizes, increasing, total > 0
  double blank_right = 0, blank_wrong = 0;  ///< size 0 (no triangle): psi = chance
  double reference_size = 1;

  [[nodiscard]] double trials() const;
  [[nodiscard]] double first() const { return levels.front().ln_size; }
  [[nodiscard]] double last() const { return levels.back().ln_size; }
  /// Returns ln(size / reference size).
  [[nodiscard]] double relative(double size) const;
  /// Returns the size at a relative logarithm; empty if a double cannot represent it.
  [[nodiscard]] std::optional<double> size_at(double ln_size) const;
};

/// Maximum number of trials of one fit. The ln likelihood of n trials is about n, so its rounding error is 2e-16 n. An
/// interval is defined by a drop of 3.84. The relative error of this drop is below 2e-4 for 1e12 trials, and a fifth
/// for 1e15 trials.
inline constexpr double most_trials = 1e12;

/// Whether counts of correct answers are integers or sums of probabilities.
enum class Counts { whole, fractional };

/// Checks the levels. Sizes must be 0 or positive normal numbers (a denormal number has lost digits). Counts must be as
/// stated by `Counts`, with correct <= total and at most most_trials in total. Error: `invalid_input` with the first
/// invalid level.
[[nodiscard]] Result<void> validate(std::span<const Level> levels, Counts counts = Counts::whole);

/// Pools validated levels. Levels whose sizes differ by less than 1e-12 (relative) become one level.
[[nodiscard]] PooledCounts pool(std::span<const Level> levels);
/// Pools two sets, with sizes relative to the reference of the first.
[[nodiscard]] PooledCounts pool(const PooledCounts& a, const PooledCounts& b);

/// Merges neighbouring levels so that at most `most_levels` remain. Levels within one span of ln size are merged; all
/// spans have the same length. The ln size of a merged level is the mean over its levels, weighted by trials.
[[nodiscard]] PooledCounts grouped(const PooledCounts& counts, std::size_t most_levels);

/// Model parameters of the search: t = ln(threshold / reference size), q = ln slope, lapse.
using PsychometricPlace = std::array<double, 3>;
inline constexpr std::size_t place_t = 0, place_q = 1, place_lapse = 2;

/// Returns the ln likelihood without binomial coefficients.
[[nodiscard]] double log_likelihood(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place);
/// Returns the likelihood with first and second derivatives in (t, q, lapse).
[[nodiscard]] Expansion<3> expand_likelihood(const PooledCounts& counts, PsychometricForm form,
                                             const PsychometricPlace& place);
/// Gradient of ln psi (for one correct answer) and of ln(1 - psi) (for one wrong answer) in (t, q, lapse) at a relative
/// ln size.
struct Scores {
  std::array<double, 3> right{}, wrong{};
};
/// Returns the scores at a relative ln size.
[[nodiscard]] Scores scores_at(PsychometricForm form, const PsychometricPlace& place, double ln_size);

/// Returns the deviance of the model relative to one free probability per level. The deviance is summed level by level
/// to avoid a loss of digits for large counts.
[[nodiscard]] double deviance(const PooledCounts& counts, PsychometricForm form, const PsychometricPlace& place);
/// Returns the ln likelihood with one free probability per level (the blank level included).
[[nodiscard]] double saturated(const PooledCounts& counts);

/// ln likelihood in the limiting cases of the model (Prins 2019). If one of these values is the supremum, there is no
/// maximum.
struct LikelihoodLimits {
  double chance = 0;   ///< threshold -> infinity: psi = chance level everywhere
  double ceiling = 0;  ///< threshold -> 0: psi = 1 - lapse at every positive size; -infinity with an error at lapse 0
  double ceiling_lapse = 0;  ///< lapse for `ceiling`
  /// Slope -> infinity: chance level at smaller sizes, 1 - lapse at larger sizes, and any value between these at one
  /// size.
  double step = 0;
};
/// Range of the thresholds (relative ln size) of all ideal steps whose ln likelihood is at least `least`. An ideal step
/// is at chance level below the threshold and at 1 - lapse above the threshold. If a threshold between two levels is
/// included, the whole gap between these levels is included. A side without a value is unbounded.
struct StepExtent {
  bool any = false;  ///< false: no ideal step has this likelihood
  std::optional<double> low, high;
};
/// Computes the range of StepExtent. `lapse` as in likelihood_limits().
[[nodiscard]] StepExtent step_extent(const PooledCounts& counts, std::optional<double> lapse, double least);
/// Computes the values of LikelihoodLimits. `lapse`: fixed lapse; empty: free in [0, 0.1].
[[nodiscard]] LikelihoodLimits likelihood_limits(const PooledCounts& counts, std::optional<double> lapse);

}  // namespace todbench
