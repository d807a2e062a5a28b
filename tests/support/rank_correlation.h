// SPDX-License-Identifier: GPL-3.0-or-later
// Agreement of two rankings: Spearman's coefficient with an interval for small samples.
#pragma once

#include <cstdint>
#include <span>

#include "acquisition/base/interval.h"
#include "acquisition/base/result.h"

namespace todbench {

/// Spearman's coefficient with its interval.
struct RankCorrelation {
  double rho = 0;   ///< Spearman's coefficient, ties with their mean rank
  Interval ci95{};  ///< of the coefficient of the population from which the items are drawn
  double p = 1;     ///< probability of a coefficient at least as far from 0 if the rankings are independent
};

/// Options of rank_correlation().
struct RankCorrelationOptions {
  int draws = 4000;  ///< simulated samples for the interval and for p
  std::uint64_t seed = 1;
};

/// Computes Spearman's coefficient of two lists with one value for each item. The interval inverts the test of the
/// coefficient: it contains the populations under which a coefficient this large, or this small, has a probability of
/// at least 2.5 %. The populations have a normal copula; ranks depend only on the copula of a distribution. It is valid
/// for few items and for a coefficient of 1, for which approximations by a standard error have no width. Errors:
/// `invalid_input` (lists of different lengths, fewer than four items, values that are not finite, a list of equal
/// values).
[[nodiscard]] Result<RankCorrelation> rank_correlation(std::span<const double> a, std::span<const double> b,
                                                       const RankCorrelationOptions& options = {});

}  // namespace todbench
