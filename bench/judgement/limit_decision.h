// One limit, one value with its interval: the decision by a named rule, and the probability that it is wrong.
#pragma once

#include <optional>

#include "bench/judgement/conformity.h"
#include "tod/psychometric/psychometric_fit.h"

namespace todbench {

enum class LimitScale {
  linear,
  logarithmic,  ///< of a ratio, such as S75: the interval is symmetric in the logarithm
};

/// What is asked. The interval is of 95 %.
struct LimitQuestion {
  std::optional<double> value{};
  Interval interval{};
  double limit = 0;
  bool at_least = true;  ///< false: at most
  LimitScale scale = LimitScale::linear;
  std::optional<double> degrees_of_freedom{};  ///< of the interval; nothing: very many
};

struct LimitAnswer {
  ConformityDecision decision = ConformityDecision::inconclusive;
  /// Probability that the true value meets the limit, with little prior knowledge (JCGM 106:2012, 7): normal, or
  /// Student's t, with the half-width of the interval on the side of the limit. Nothing without a value or that side.
  std::optional<double> p_conformity{};
};

/// The guard band on each side is that side's half-width; with `guard_band_risk` that which leaves this risk of a wrong
/// acceptance at the acceptance limit. A value on the limit meets it. What the interval leaves open is inconclusive
/// under every rule. Precondition: 0 < guard_band_risk <= 0.5.
[[nodiscard]] LimitAnswer decide(const LimitQuestion& question, ConformityRule rule,
                                 const std::optional<double>& guard_band_risk);

}  // namespace todbench
