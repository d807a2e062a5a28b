// SPDX-License-Identifier: GPL-3.0-or-later
// Decision on one limit for a value with its interval, by a named rule, and the probability that the true value meets
// the limit.
#pragma once

#include <optional>

#include "bench/judgement/conformity.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

/// Scale on which the interval is symmetric.
enum class LimitScale {
  linear,
  logarithmic,  ///< for ratio scales (S75): the interval is symmetric in the logarithm
};

/// Input of a decision. The interval has 95 % confidence.
struct LimitQuestion {
  std::optional<double> value{};
  Interval interval{};
  double limit = 0;
  bool at_least = true;  ///< false: at most
  LimitScale scale = LimitScale::linear;
  std::optional<double> degrees_of_freedom{};  ///< degrees of freedom of the interval; empty: infinite
};

/// Result of a decision.
struct LimitAnswer {
  ConformityDecision decision = ConformityDecision::inconclusive;
  /// Probability that the true value meets the limit, with little prior knowledge (JCGM 106:2012, 7): normal or
  /// Student's t, with the half-width towards the limit. Empty without a value, or without a limit of the interval on
  /// that side.
  std::optional<double> p_conformity{};
};

/// Decides by `rule`. The guard band on each side is the half-width of the interval on that side. `guard_band_risk`
/// replaces this width by the width at which a value at the acceptance limit has this risk of a wrong acceptance. A
/// value on the limit meets the limit. If an open interval does not allow a decision, the result is inconclusive under
/// every rule. Precondition: 0 < guard_band_risk <= 0.5.
[[nodiscard]] LimitAnswer decide(const LimitQuestion& question, ConformityRule rule,
                                 const std::optional<double>& guard_band_risk);

}  // namespace todbench
