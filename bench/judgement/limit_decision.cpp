// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/limit_decision.h"

#include <algorithm>
#include <cmath>

#include "acquisition/base/distributions.h"

namespace todbench {
namespace {

double upper_quantile(double tail, const std::optional<double>& degrees_of_freedom) {
  return tail == 0.5 ? 0 : distribution::quantile_above(tail, degrees_of_freedom);
}

double below(double z, const std::optional<double>& degrees_of_freedom) {
  if (degrees_of_freedom) return cdf(distribution::StudentsT(*degrees_of_freedom), z);
  return cdf(distribution::Normal(), z);
}

/// Returns the end of an interval with its distance to the value multiplied by `factor`; exactly the end for factor 1.
std::optional<double> scaled(const std::optional<double>& end, const LimitQuestion& asked, double factor) {
  if (!end || factor == 1) return end;
  if (!asked.value) return end;
  if (asked.scale == LimitScale::linear) return *asked.value + factor * (*end - *asked.value);
  return *asked.value * std::pow(*end / *asked.value, factor);
}

std::optional<double> p_conformity(const LimitQuestion& asked) {
  if (!asked.value) return std::nullopt;
  const bool meets = asked.at_least ? *asked.value >= asked.limit : *asked.value <= asked.limit;
  // This side of the interval faces the limit.
  const auto& side = meets == asked.at_least ? asked.interval.low : asked.interval.high;
  if (!side) return std::nullopt;
  double half = *side - *asked.value, distance = asked.limit - *asked.value;
  if (asked.scale == LimitScale::logarithmic) {
    if (!(*side > 0) || !(*asked.value > 0) || !(asked.limit > 0)) return std::nullopt;
    half = std::log(*side / *asked.value);
    distance = std::log(asked.limit / *asked.value);
  }
  if (half == 0) return std::nullopt;
  constexpr double tail = 0.025;
  const double z = std::abs(distance / half) * upper_quantile(tail, asked.degrees_of_freedom);
  return meets ? below(z, asked.degrees_of_freedom) : below(-z, asked.degrees_of_freedom);
}

}  // namespace

LimitAnswer decide(const LimitQuestion& question, ConformityRule rule, const std::optional<double>& guard_band_risk) {
  LimitAnswer answer{.p_conformity = p_conformity(question)};
  const double factor = guard_band_risk ? upper_quantile(*guard_band_risk, question.degrees_of_freedom) /
                                              upper_quantile(0.025, question.degrees_of_freedom)
                                        : 1;
  const auto low = scaled(question.interval.low, question, factor);
  const auto high = scaled(question.interval.high, question, factor);
  const bool accepted = question.at_least ? low && *low >= question.limit : high && *high <= question.limit;
  const bool rejected = question.at_least ? high && *high < question.limit : low && *low > question.limit;
  const bool identified = question.value && low && high;
  const bool meets =
      question.value && (question.at_least ? *question.value >= question.limit : *question.value <= question.limit);
  if (accepted || rejected) answer.decision = accepted ? ConformityDecision::pass : ConformityDecision::fail;
  if (!identified) return answer;
  switch (rule) {
    case ConformityRule::guarded_acceptance_and_rejection:
      break;
    case ConformityRule::simple:
      answer.decision = meets ? ConformityDecision::pass : ConformityDecision::fail;
      break;
    case ConformityRule::guarded:
      answer.decision = accepted ? ConformityDecision::pass : ConformityDecision::fail;
      break;
    case ConformityRule::non_binary:
      if (!accepted && !rejected)
        answer.decision = meets ? ConformityDecision::conditional_pass : ConformityDecision::conditional_fail;
      break;
  }
  return answer;
}

}  // namespace todbench
