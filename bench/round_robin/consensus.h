// SPDX-License-Identifier: GPL-3.0-or-later
// Consensus of laboratories that measured the same item: reference values, consistency, scatter between laboratories.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "acquisition/base/interval.h"

namespace todbench {

/// Result of one laboratory for one item. The unit of the value is the unit of the item.
struct LaboratoryValue {
  std::string laboratory;
  double value = 0;
  double u = 0;  ///< standard uncertainty, above 0
};

/// Value with its standard uncertainty.
struct Consensus {
  double value = 0, u = 0;
};

/// Significance of the consistency check (Cox 2002, section 5).
inline constexpr double comparison_significance = 0.05;

/// Precondition of all functions below: at least two values, each with a finite value and a finite u above 0.

/// Returns the mean with weights 1/u^2 (Cox 2002, equations 3 and 4).
[[nodiscard]] Consensus weighted_mean(std::span<const LaboratoryValue> values);

/// Chi-squared test that the stated uncertainties explain the scatter (Cox 2002, section 5, step 3).
struct ConsistencyCheck {
  double chi2 = 0;
  int degrees_of_freedom = 0;
  double p = 1;            ///< probability of a larger chi2 by chance
  double birge_ratio = 0;  ///< sqrt(chi2 / degrees of freedom) (Birge 1932)
  [[nodiscard]] bool consistent() const { return p >= comparison_significance; }
};
/// Tests the consistency of these values.
[[nodiscard]] ConsistencyCheck consistency(std::span<const LaboratoryValue> values);

/// Returns the positions of the largest consistent subset. Among several subsets of this size, chooses the subset with
/// the smallest chi2 (Cox 2007). With up to 16 values, every subset is tried. With more values, the function removes
/// the value farthest from the mean of the other values, in units of its uncertainty, until the remaining values are
/// consistent.
[[nodiscard]] std::vector<std::size_t> largest_consistent_subset(std::span<const LaboratoryValue> values);

/// Median by Monte Carlo (Cox 2002, procedure B). The same seed gives the same draws.
struct MedianConsensus {
  Consensus median;  ///< mean and standard deviation of the medians of the draws
  Interval ci95;     ///< shortest interval with 95 % of the medians
  /// For each value: half of the shortest interval with 95 % of value minus median; empty unless requested.
  std::vector<double> difference_half95;
};
/// Results of monte_carlo_median(): the median alone, or also the differences.
enum class MedianDetail { median, differences };
inline constexpr int median_draws = 20'000;
/// Computes the median.
[[nodiscard]] MedianConsensus monte_carlo_median(std::span<const LaboratoryValue> values, std::uint64_t seed,
                                                 MedianDetail detail);

/// Return the variance between laboratories in excess of their uncertainties, 0 or more. The first is the estimate of
/// moments by DerSimonian and Laird 1986 (equation 8). The second is the estimate by Paule and Mandel 1982, at which
/// the generalised chi2 equals its expectation N - 1 (N: number of values).
[[nodiscard]] double dersimonian_laird_variance(std::span<const LaboratoryValue> values);
[[nodiscard]] double paule_mandel_variance(std::span<const LaboratoryValue> values);

/// Mean with weights 1/(u^2 + variance).
struct RandomEffects {
  Consensus mean;  ///< u for known variances
  /// Standard error of Hartung and Knapp 2001, at least mean.u; used with Student's t (number of values minus 1).
  double hartung_knapp = 0;
};
/// Returns the mean for a given variance between laboratories.
[[nodiscard]] RandomEffects random_effects(std::span<const LaboratoryValue> values, double variance);

}  // namespace todbench
