// SPDX-License-Identifier: GPL-3.0-or-later
// Distribution of earlier units of the same kind as a prior, and the risks of a decision with it (JCGM 106:2012).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/judgement/conformity.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Value and standard uncertainty of one unit, on the scale of the fleet (ln of an acuity).
struct UnitValue {
  double value = 0;
  double u = 0;
};

/// Normal distribution of the true values, estimated from a number of units.
struct FleetPrior {
  double mean = 0;
  /// Standard deviation of the true values: square root of (variance of the values - mean u^2).
  double sd = 0;
  double u = 0;  ///< root mean square of the uncertainties of the values
  int units = 0;
};

/// Estimates the prior from these units. Errors: `invalid_input` (fewer than least_fleet_units, a value without
/// uncertainty, or a scatter that does not exceed the uncertainties, so that the spread is unknown).
[[nodiscard]] Result<FleetPrior> fleet_prior(std::span<const UnitValue> units);

/// 95 % interval of the standard deviation, from the chi-squared distribution of the variance of the values. Its lower
/// limit may be 0.
struct SpreadInterval {
  double low = 0, high = 0;
};
/// Returns the interval of the standard deviation of a prior.
[[nodiscard]] SpreadInterval spread_interval(const FleetPrior& prior);

/// Risks of a measured unit. The value and u of the unit are on the scale of the prior. The measurement error divided
/// by u is normal or follows Student's t. The true value is drawn from the fleet. The mean of the fleet has the
/// standard uncertainty sqrt((sd^2 + u^2) / units), and the variances add. `p_conformity`: share of the posterior
/// inside the tolerance (JCGM 106:2012, 7.2). The other members are as in GlobalRisks (JCGM 106:2012, 9). `..._most`:
/// the largest of the values at the estimated standard deviation and at both limits of its interval.
struct FleetRisks {
  double p_conformity = 0;
  double consumer_risk = 0, producer_risk = 0;
  double consumer_risk_most = 0, producer_risk_most = 0;
};
/// Computes the risks. Errors: those of global_risks().
[[nodiscard]] Result<FleetRisks> fleet_risks(const FleetPrior& prior, const MeasuredValue& measured,
                                             const ToleranceLimits& tolerance, const ToleranceLimits& acceptance);

/// Forecast of the effect of a limit on future units of a fleet. `..._most`: the largest of the values at the estimated
/// standard deviation and at both limits of its interval.
struct FleetForecast {
  int units = 0;             ///< number of units of the prior
  double p_good = 0;         ///< probability that a unit is inside the tolerance
  double good_rejected = 0;  ///< share of the conforming units that are not accepted
  double good_rejected_most = 0;
  double bad_accepted = 0;  ///< share of all units that are accepted and outside the tolerance
  double bad_accepted_most = 0;
};
/// Forecasts for units measured with standard uncertainty `u` on the scale of the prior. Errors: global_risks().
[[nodiscard]] Result<FleetForecast> fleet_forecast(const FleetPrior& prior, double u, const ToleranceLimits& tolerance,
                                                   const ToleranceLimits& acceptance);

/// Returns the row of the plan for a demand; null if absent.
[[nodiscard]] const FleetRow* fleet_of(const LimitsPlan& limits, const Demand& demand);
/// Returns the prior of a row; for an acuity, in ln acuity.
[[nodiscard]] FleetPrior prior_of(const FleetRow& row);

/// Adds the risks to every demand that has a number, both limits of its interval, and a fleet row in the plan. u is the
/// half-width of the interval towards the limit, divided by 1.96 or by Student's t for the degrees of freedom of the
/// demand. The decision rule determines the acceptance limit.
void add_fleet_risks(std::vector<Demand>& demands, const LimitsPlan& limits);

}  // namespace todbench
