// SPDX-License-Identifier: GPL-3.0-or-later
// Two-interval decisions of an observer: share of correct answers, computed from the scores of the observer, and
// contrast for 75 % correct answers.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace todbench {

/// Scores of an observer for intervals with a pattern: [phase or set-up][draw].
using IntervalScores = std::vector<std::vector<float>>;

/// Share of correct decisions that defines a threshold.
inline constexpr double threshold_share = 0.75;

/// Share of correctly decided pairs, with its standard error.
struct ShareOfPairs {
  double mean = 0, standard_error = 0;
};

/// Returns the share of pairs of draws in which the score for `pattern` is larger. A pair consists of one draw from
/// `pattern` and one from `other`. Pairs with equal draw numbers are excluded. Standard error after DeLong et al.
/// (1988), Biometrics 44. Precondition: at least two draws, all rows of equal length.
[[nodiscard]] ShareOfPairs share_of_pairs(const IntervalScores& pattern, const IntervalScores& other);

/// Lowest contrast at which the share increases beyond 75 %. The probit of the share is interpolated linearly in ln
/// contrast.
struct PassedContrast {
  std::optional<double> contrast_k;
  double relative_error = 0;
};
/// Computes the lowest contrast at which the share increases beyond 75 %; `contrast_k` is empty if there is none.
[[nodiscard]] PassedContrast passed_contrast(std::span<const double> contrasts_k, std::span<const ShareOfPairs> shares);

/// Psychometric function of the contrast c, Phi(z75 (c / threshold)^exponent), z75 = 0.674: sensitivity d' is a power
/// function of contrast (Foley and Legge 1981). After sampling, the energy of a pattern depends on the phase p of the
/// pattern, because the spectrum interferes with its repeats at integer cycles per sample. The threshold is inversely
/// proportional to the square root of the energy: threshold = level / sqrt(1 + swing[0] cos(2 pi p) + swing[1] sin(2 pi
/// p)). The sine term is needed if the position of the pattern has an unknown offset of a fraction of a sample.
struct ContrastFunction {
  double level_k = 0;             ///< threshold for the mean energy over the phases
  double exponent = 1;            ///< between 0.3 and 8
  std::array<double, 2> swing{};  ///< 0 if phases were not fitted

  /// Returns ln threshold at a phase minus ln level.
  [[nodiscard]] double ln_ratio_at(double phase) const;
  /// Returns the phase of the lowest threshold, in -0.5 to 0.5.
  [[nodiscard]] double best_phase() const;
};

/// A share of correct decisions at a contrast.
struct ContrastShare {
  double contrast_k = 0;  ///< > 0
  double share = 0;
  double phase = 0;  ///< position of the pattern relative to the samples, in samples
};

/// Whether the swing over phases is fitted.
enum class PhaseFit { none, swing };

/// Fits the function by weighted least squares to the shares at contrasts within a factor of `fitted_span` of `near_k`.
/// Weights are the inverse binomial variances. Empty if the shares do not determine a threshold in this range.
[[nodiscard]] std::optional<ContrastFunction> fit_contrast(std::span<const ContrastShare> shares, double near_k,
                                                           PhaseFit phases = PhaseFit::none);
/// Range of fit_contrast(), as a factor. It contains three or four contrasts of a series with steps of factor 2.
inline constexpr double fitted_span = 3.3;

}  // namespace todbench
