// SPDX-License-Identifier: GPL-3.0-or-later
// Joint fit of two data sets, with a common threshold and with separate thresholds.
#pragma once

#include <optional>
#include <span>

#include "tod/psychometric/psychometric_search.h"

namespace todbench {

/// Maxima of the summed ln likelihood with separate thresholds and with a common threshold.
struct PairMaxima {
  double ll_separate = 0, ll_common = 0;
  double ln_ratio = 0;                ///< ln(threshold A / threshold B) at the maximum with separate thresholds
  std::optional<double> se_ln_ratio;  ///< from the observed information; empty if the information is singular
};

/// Joint fit of two data sets. A free lapse is fitted separately in each set. Precondition: levels are valid, and each
/// set has answers at a positive size.
class ThresholdPair {
 public:
  ThresholdPair(std::span<const Level> a, std::span<const Level> b, const FitOptions& options);

  /// Fits one slope for both sets, with a common threshold and with separate thresholds.
  [[nodiscard]] PairMaxima shared_slope() const;
  /// Fits one slope for each set, with a common threshold and with separate thresholds.
  [[nodiscard]] PairMaxima separate_slopes() const;

 private:
  PooledCounts a_, b_;  ///< with sizes relative to the same reference
  PsychometricForm form_;
  std::optional<double> lapse_;
  ScanGrid grid_;
  LikelihoodScan scan_a_, scan_b_;
};

}  // namespace todbench
