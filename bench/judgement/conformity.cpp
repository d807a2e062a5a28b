// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/conformity.h"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"

namespace todbench {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Probabilities below, above and within an interval. Small ones keep their relative precision.
struct Shares {
  double below = 0, within = 0, above = 0;
};

template <typename Distribution>
Shares shares_of(const Distribution& standard, double low, double high) {
  const auto below = [&](double z) { return z == -infinite ? 0.0 : z == infinite ? 1.0 : cdf(standard, z); };
  const auto above = [&](double z) {
    return z == infinite ? 0.0 : z == -infinite ? 1.0 : cdf(complement(standard, z));
  };
  Shares shares{below(low), 0, above(high)};
  if (low >= high) return shares;
  if (low > 0)
    shares.within = above(low) - above(high);
  else if (high < 0)
    shares.within = below(high) - below(low);
  else
    shares.within = 1 - shares.below - shares.above;
  return shares;
}

Shares shares_of(const MeasuredValue& measured, const ToleranceLimits& limits) {
  const auto standard = [&](double limit) { return (limit - measured.value) / measured.u; };
  const double low = limits.at_least ? standard(*limits.at_least) : -infinite;
  const double high = limits.at_most ? standard(*limits.at_most) : infinite;
  if (measured.degrees_of_freedom) return shares_of(distribution::StudentsT(*measured.degrees_of_freedom), low, high);
  return shares_of(distribution::Normal(), low, high);
}

/// Returns the distance of the value to the nearer limit, positive inside.
double margin_of(double value, const ToleranceLimits& limits) {
  return std::min(limits.at_least ? value - *limits.at_least : infinite,
                  limits.at_most ? *limits.at_most - value : infinite);
}

/// Returns the rounding error of sums and differences of these numbers: 0.94 lies on the limit 0.9 + 0.04.
double rounding_of(double value, const ToleranceLimits& limits, double guard_band) {
  const double largest = std::max(
      {std::abs(value), std::abs(limits.at_least.value_or(0)), std::abs(limits.at_most.value_or(0)), guard_band});
  return 8 * std::numeric_limits<double>::epsilon() * largest;
}

ConformityDecision decision_of(double margin, double band, double rounding, ConformityRule rule) {
  const bool inside = margin >= -rounding, accepted = margin >= band - rounding;
  const bool near = margin >= -band - rounding;
  switch (rule) {
    case ConformityRule::simple:
      return inside ? ConformityDecision::pass : ConformityDecision::fail;
    case ConformityRule::guarded:
      return accepted ? ConformityDecision::pass : ConformityDecision::fail;
    case ConformityRule::non_binary:
      if (accepted) return ConformityDecision::pass;
      if (inside) return ConformityDecision::conditional_pass;
      return near ? ConformityDecision::conditional_fail : ConformityDecision::fail;
    case ConformityRule::guarded_acceptance_and_rejection:
      if (accepted) return ConformityDecision::pass;
      return near ? ConformityDecision::inconclusive : ConformityDecision::fail;
  }
  return ConformityDecision::inconclusive;
}

Result<void> check(const ToleranceLimits& limits) {
  if (!limits.at_least && !limits.at_most)
    return fail(ErrorCode::invalid_input, "there is no limit: state a lower limit, an upper limit or both");
  if (!std::isfinite(limits.at_least.value_or(0)) || !std::isfinite(limits.at_most.value_or(0)))
    return fail(ErrorCode::invalid_input, "a limit is not a finite number");
  if (limits.at_least && limits.at_most && *limits.at_least >= *limits.at_most)
    return fail(ErrorCode::invalid_input, "the lower limit must be below the upper limit");
  return {};
}

bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

}  // namespace

std::string_view to_string(ConformityDecision decision) {
  switch (decision) {
    case ConformityDecision::pass:
      return "pass";
    case ConformityDecision::conditional_pass:
      return "conditional pass";
    case ConformityDecision::inconclusive:
      return "inconclusive";
    case ConformityDecision::conditional_fail:
      return "conditional fail";
    case ConformityDecision::fail:
      return "fail";
  }
  return "";
}

Result<Conformity> conformity(const MeasuredValue& measured, const ToleranceLimits& tolerance, ConformityRule rule,
                              double guard_band) {
  TODBENCH_TRY_VOID(check(tolerance));
  if (!std::isfinite(measured.value)) return fail(ErrorCode::invalid_input, "the value is not a finite number");
  if (!positive(measured.u)) return fail(ErrorCode::invalid_input, "the standard uncertainty must be greater than 0");
  if (measured.degrees_of_freedom && !positive(*measured.degrees_of_freedom))
    return fail(ErrorCode::invalid_input, "the degrees of freedom must be greater than 0");
  if (!std::isfinite(guard_band) || guard_band < 0)
    return fail(ErrorCode::invalid_input, "the guard band must be at least 0");
  Conformity found;
  found.guard_band = rule == ConformityRule::simple ? 0 : guard_band;
  if (tolerance.at_least) found.acceptance.at_least = *tolerance.at_least + found.guard_band;
  if (tolerance.at_most) found.acceptance.at_most = *tolerance.at_most - found.guard_band;
  const double rounding = rounding_of(measured.value, tolerance, found.guard_band);
  found.acceptance_zone_is_empty = tolerance.at_least && tolerance.at_most &&
                                   2 * found.guard_band > *tolerance.at_most - *tolerance.at_least + rounding;
  found.decision = decision_of(margin_of(measured.value, tolerance), found.guard_band, rounding, rule);
  const Shares shares = shares_of(measured, tolerance);
  found.p_conformity = shares.within;
  found.p_nonconformity = shares.below + shares.above;
  return found;
}

double guard_band_for_risk(double risk, const MeasuredValue& measured) {
  if (risk == 0.5) return 0;
  return measured.u * distribution::quantile_above(risk, measured.degrees_of_freedom);
}

double usual_guard_band(const MeasuredValue& measured) {
  // 95.45 %: factor 2 if u is well known, otherwise Student's t.
  if (measured.degrees_of_freedom) return guard_band_for_risk(distribution::tail_above(2, std::nullopt), measured);
  return 2 * measured.u;
}

Result<GlobalRisks> global_risks(const Fleet& fleet, const MeasurementError& error, const ToleranceLimits& tolerance,
                                 const ToleranceLimits& acceptance) {
  const double u = error.u;
  TODBENCH_TRY_VOID(check(tolerance));
  if (!std::isfinite(fleet.mean) || !positive(fleet.sd) || !positive(u))
    return fail(ErrorCode::invalid_input,
                "the standard deviation of the fleet and the uncertainty must be greater than 0");
  if (error.degrees_of_freedom && !positive(*error.degrees_of_freedom))
    return fail(ErrorCode::invalid_input, "the degrees of freedom must be greater than 0");
  // The integrand is smooth between these points: the limits and the flanks of the acceptance probability.
  constexpr double reach_sd = 10;
  std::vector<double> points{fleet.mean - reach_sd * fleet.sd, fleet.mean, fleet.mean + reach_sd * fleet.sd};
  for (const auto& limit : {tolerance.at_least, tolerance.at_most}) {
    if (limit) points.push_back(*limit);
  }
  for (const auto& limit : {acceptance.at_least, acceptance.at_most}) {
    // The outer steps cover the slow tails for few degrees of freedom.
    for (const double step : {-1000.0, -100.0, -25.0, -8.0, -3.0, 0.0, 3.0, 8.0, 25.0, 100.0, 1000.0}) {
      if (limit) points.push_back(*limit + step * u);
    }
  }
  std::sort(points.begin(), points.end());
  const double first = fleet.mean - reach_sd * fleet.sd, last = fleet.mean + reach_sd * fleet.sd;
  GlobalRisks risks;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double low = std::max(first, points[i - 1]), high = std::min(last, points[i]);
    if (!(low < high)) continue;
    const bool conforming = margin_of(0.5 * (low + high), tolerance) >= 0;
    const auto share = [&](bool accepted) {
      const auto density = [&](double x) {
        const double z = (x - fleet.mean) / fleet.sd;
        const Shares shares = shares_of({x, u, error.degrees_of_freedom}, acceptance);
        const double p = accepted ? shares.within : std::min(1.0, shares.below + shares.above);
        return std::exp(-0.5 * z * z) / (fleet.sd * std::sqrt(2 * std::numbers::pi)) * p;
      };
      return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(density, low, high, 8, 1e-12);
    };
    const double accepted = share(true), rejected = share(false);
    risks.p_accepted += accepted;
    if (conforming)
      risks.p_conforming += accepted + rejected, risks.producer_risk += rejected;
    else
      risks.consumer_risk += accepted;
  }
  if (risks.p_accepted > 0) risks.p_nonconforming_if_accepted = risks.consumer_risk / risks.p_accepted;
  return risks;
}

}  // namespace todbench
