// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/judgement/fleet_prior.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

#include "acquisition/base/distributions.h"
#include "acquisition/base/try.h"
#include "bench/judgement/demand_kinds.h"

namespace todbench {
namespace {

/// Returns the variance of the true value of a future unit, including the uncertainty of the fleet's mean.
double predictive_variance(const FleetPrior& prior, double sd) {
  return sd * sd + (sd * sd + prior.u * prior.u) / prior.units;
}

/// Returns the share of prior times likelihood inside the tolerance. The error over u follows Student's t, which has no
/// conjugate prior.
double share_inside_by_t(double mean, double sd, const MeasuredValue& measured, const ToleranceLimits& tolerance) {
  constexpr double reach_sd = 10;
  const double first = mean - reach_sd * sd, last = mean + reach_sd * sd;
  const double freedom = *measured.degrees_of_freedom;
  const auto density = [&](double x) {
    const double z = (x - mean) / sd, t = (measured.value - x) / measured.u;
    return std::exp(-0.5 * z * z - 0.5 * (freedom + 1) * std::log1p(t * t / freedom));
  };
  // The integrand is smooth between these points.
  std::vector<double> points{first, mean, last};
  for (const double step : {-100.0, -25.0, -8.0, -3.0, 0.0, 3.0, 8.0, 25.0, 100.0})
    points.push_back(std::clamp(measured.value + step * measured.u, first, last));
  for (const auto& limit : {tolerance.at_least, tolerance.at_most}) {
    if (limit) points.push_back(std::clamp(*limit, first, last));
  }
  std::sort(points.begin(), points.end());
  double inside = 0, all = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double low = points[i - 1], high = points[i], middle = 0.5 * (low + high);
    if (!(low < high)) continue;
    const double part = boost::math::quadrature::gauss_kronrod<double, 31>::integrate(density, low, high, 8, 1e-12);
    all += part;
    if (!(middle < tolerance.at_least.value_or(first)) && !(middle > tolerance.at_most.value_or(last))) inside += part;
  }
  return all > 0 ? inside / all : 0;
}

/// Returns the same share for a normal prior and a normal error.
double posterior_share_inside(const FleetPrior& prior, const MeasuredValue& measured,
                              const ToleranceLimits& tolerance) {
  const double of_fleet = predictive_variance(prior, prior.sd), of_unit = measured.u * measured.u;
  if (measured.degrees_of_freedom) return share_inside_by_t(prior.mean, std::sqrt(of_fleet), measured, tolerance);
  const double weight = of_fleet / (of_fleet + of_unit);
  const distribution::Normal posterior(weight * measured.value + (1 - weight) * prior.mean,
                                       std::sqrt(weight * of_unit));
  double outside = 0;
  if (tolerance.at_least) outside += cdf(posterior, *tolerance.at_least);
  if (tolerance.at_most) outside += cdf(complement(posterior, *tolerance.at_most));
  return 1 - outside;
}

/// Demand as a measured value on the scale of its prior.
struct Scaled {
  MeasuredValue measured;
  ToleranceLimits tolerance, acceptance;
};

std::optional<Scaled> scaled_demand(const Demand& demand, const LimitsPlan& limits) {
  const LimitSide side = row_of(demand.kind).side;
  if (side == LimitSide::none || !demand.result || !demand.limit || !demand.interval.low || !demand.interval.high)
    return std::nullopt;
  const bool of_ratio = demand.kind == DemandKind::acuity;
  if (of_ratio && !(*demand.interval.low > 0 && *demand.result > 0 && *demand.limit > 0)) return std::nullopt;
  const auto on_scale = [&](double value) { return of_ratio ? std::log(value) : value; };
  const double value = on_scale(*demand.result), limit = on_scale(*demand.limit);
  const bool at_least = side == LimitSide::at_least;
  // The side of the interval towards the limit decides on acceptance.
  const double half = std::abs(value - on_scale(at_least ? *demand.interval.low : *demand.interval.high));
  if (!(half > 0)) return std::nullopt;
  constexpr double tail = 0.025;
  const MeasuredValue measured{.value = value,
                               .u = half / distribution::quantile_above(tail, demand.degrees_of_freedom),
                               .degrees_of_freedom = demand.degrees_of_freedom};
  double guard_band = limits.rule == ConformityRule::simple ? 0 : half;
  if (guard_band > 0 && limits.guard_band_risk) guard_band = guard_band_for_risk(*limits.guard_band_risk, measured);
  Scaled out{.measured = measured, .tolerance = {}, .acceptance = {}};
  (at_least ? out.tolerance.at_least : out.tolerance.at_most) = limit;
  (at_least ? out.acceptance.at_least : out.acceptance.at_most) = at_least ? limit + guard_band : limit - guard_band;
  return out;
}

}  // namespace

Result<FleetPrior> fleet_prior(std::span<const UnitValue> units) {
  const auto n = static_cast<double>(units.size());
  if (units.size() < least_fleet_units) {
    return fail(ErrorCode::invalid_input, fmt::format("the fleet has too few units: found {}, expected at least {}",
                                                      units.size(), least_fleet_units));
  }
  double mean = 0, u_squares = 0, squares = 0;
  for (const UnitValue& unit : units) {
    if (!std::isfinite(unit.value) || !std::isfinite(unit.u) || !(unit.u > 0))
      return fail(ErrorCode::invalid_input, "a unit of the fleet has no standard uncertainty above 0");
    mean += unit.value / n;
    u_squares += unit.u * unit.u / n;
  }
  for (const UnitValue& unit : units) squares += (unit.value - mean) * (unit.value - mean) / (n - 1);
  if (!(squares > u_squares)) {
    return fail(ErrorCode::invalid_input,
                fmt::format("the units scatter by {:.3g}, which is not more than their own uncertainty of {:.3g}: the "
                            "spread of the fleet cannot be determined",
                            std::sqrt(squares), std::sqrt(u_squares)));
  }
  return FleetPrior{.mean = mean,
                    .sd = std::sqrt(squares - u_squares),
                    .u = std::sqrt(u_squares),
                    .units = static_cast<int>(units.size())};
}

SpreadInterval spread_interval(const FleetPrior& prior) {
  const double freedom = prior.units - 1, of_values = prior.sd * prior.sd + prior.u * prior.u;
  const distribution::ChiSquared chi(freedom);
  constexpr double tail = 0.025;
  const auto of = [&](double quantile_of_chi) {
    return std::sqrt(std::max(0.0, of_values * freedom / quantile_of_chi - prior.u * prior.u));
  };
  return {of(quantile(complement(chi, tail))), of(quantile(chi, tail))};
}

Result<FleetRisks> fleet_risks(const FleetPrior& prior, const MeasuredValue& measured, const ToleranceLimits& tolerance,
                               const ToleranceLimits& acceptance) {
  FleetRisks out;
  const SpreadInterval spread = spread_interval(prior);
  for (const double sd : {prior.sd, spread.low, spread.high}) {
    TODBENCH_TRY(const auto risks, global_risks({.mean = prior.mean, .sd = std::sqrt(predictive_variance(prior, sd))},
                                                {measured.u, measured.degrees_of_freedom}, tolerance, acceptance));
    if (sd == prior.sd) out.consumer_risk = risks.consumer_risk, out.producer_risk = risks.producer_risk;
    out.consumer_risk_most = std::max(out.consumer_risk_most, risks.consumer_risk);
    out.producer_risk_most = std::max(out.producer_risk_most, risks.producer_risk);
  }
  out.p_conformity = posterior_share_inside(prior, measured, tolerance);
  return out;
}

Result<FleetForecast> fleet_forecast(const FleetPrior& prior, double u, const ToleranceLimits& tolerance,
                                     const ToleranceLimits& acceptance) {
  FleetForecast out{.units = prior.units};
  const SpreadInterval spread = spread_interval(prior);
  for (const double sd : {prior.sd, spread.low, spread.high}) {
    const auto risks =
        global_risks({.mean = prior.mean, .sd = std::sqrt(predictive_variance(prior, sd))}, {u}, tolerance, acceptance);
    if (!risks) return tl::unexpected(risks.error());
    const double rejected = risks->p_conforming > 0 ? std::min(1.0, risks->producer_risk / risks->p_conforming) : 0;
    if (sd == prior.sd)
      out.p_good = risks->p_conforming, out.good_rejected = rejected, out.bad_accepted = risks->consumer_risk;
    out.good_rejected_most = std::max(out.good_rejected_most, rejected);
    out.bad_accepted_most = std::max(out.bad_accepted_most, risks->consumer_risk);
  }
  return out;
}

const FleetRow* fleet_of(const LimitsPlan& limits, const Demand& demand) {
  for (const FleetRow& row : limits.fleets) {
    if (demand.kind == DemandKind::acuity) {
      if (row.measure == fleet_acuity && row.delta_t_k && demand.delta_t_k &&
          same_contrast(*row.delta_t_k, *demand.delta_t_k))
        return &row;
    } else if (const Quantity* quantity = row_of(demand.kind).quantity;
               quantity != nullptr && row.measure == quantity->name) {
      return &row;
    }
  }
  return nullptr;
}

FleetPrior prior_of(const FleetRow& row) {
  return {.mean = row.measure == fleet_acuity ? std::log(row.mean) : row.mean,
          .sd = row.sd,
          .u = row.u,
          .units = row.units};
}

void add_fleet_risks(std::vector<Demand>& demands, const LimitsPlan& limits) {
  for (Demand& demand : demands) {
    const FleetRow* row = fleet_of(limits, demand);
    if (row == nullptr || !demand.p_conformity) continue;
    const auto scaled = scaled_demand(demand, limits);
    if (!scaled) continue;
    const auto risks = fleet_risks(prior_of(*row), scaled->measured, scaled->tolerance, scaled->acceptance);
    if (!risks) continue;
    demand.fleet = DemandFleet{.units = row->units,
                               .p_conformity = risks->p_conformity,
                               .consumer_risk = risks->consumer_risk,
                               .producer_risk = risks->producer_risk,
                               .consumer_risk_most = risks->consumer_risk_most,
                               .producer_risk_most = risks->producer_risk_most};
  }
}

}  // namespace todbench
