// What earlier units of a kind say of the next one: a prior, and the risks of a decision with it (JCGM 106:2012).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/judgement/conformity.h"
#include "bench/judgement/verdict.h"
#include "bench/plan/plan.h"

namespace todbench {

/// Of one unit: its value and standard uncertainty, on the scale of the fleet (ln of an acuity).
struct UnitValue {
  double value = 0;
  double u = 0;
};

/// True values of the fleet, taken as normal, as far as so many units tell.
struct FleetPrior {
  double mean = 0;
  double sd = 0;  ///< of true values: variance of the values less the mean u^2
  double u = 0;   ///< root mean square of those of the values
  int units = 0;
};

/// The prior of these units. `invalid_input`: fewer than least_fleet_units, a value without uncertainty, or values that
/// scatter by no more than their uncertainties, which say nothing of the spread.
[[nodiscard]] Result<FleetPrior> fleet_prior(std::span<const UnitValue> units);

/// 95 % interval of the standard deviation, by chi-squared of the variance of the values; its low end may be 0.
struct SpreadInterval {
  double low = 0, high = 0;
};
[[nodiscard]] SpreadInterval spread_interval(const FleetPrior& prior);

/// A unit that was measured, normal: value and u as of the prior's scale. Its own true value is drawn from the fleet,
/// whose mean is known to sqrt((sd^2 + u^2) / units): the variances add. `p_conformity` is the posterior's share inside
/// the tolerance (JCGM 106:2012, 7.2), the others as GlobalRisks (9). `most`: the largest with the ends of the spread's
/// interval.
struct FleetRisks {
  double p_conformity = 0;
  double consumer_risk = 0, producer_risk = 0;
  double consumer_risk_most = 0, producer_risk_most = 0;
};
/// Errors: global_risks().
[[nodiscard]] Result<FleetRisks> fleet_risks(const FleetPrior& prior, const MeasuredValue& measured,
                                             const ToleranceLimits& tolerance, const ToleranceLimits& acceptance);

/// What a limit will do to units of a fleet that are yet to be measured. `most`: the largest with the ends of the
/// spread's interval.
struct FleetForecast {
  int units = 0;             ///< that the prior is of
  double p_good = 0;         ///< inside the tolerance
  double good_rejected = 0;  ///< share of the good ones that are not accepted
  double good_rejected_most = 0;
  double bad_accepted = 0;  ///< share of all units: accepted and outside
  double bad_accepted_most = 0;
};
/// Of units that are measured with standard uncertainty `u`, on the scale of the prior. Errors: global_risks().
[[nodiscard]] Result<FleetForecast> fleet_forecast(const FleetPrior& prior, double u, const ToleranceLimits& tolerance,
                                                   const ToleranceLimits& acceptance);

/// The row of the plan that a demand is about; null: there is none.
[[nodiscard]] const FleetRow* fleet_of(const LimitsPlan& limits, const Demand& demand);
/// The prior of a row, on its scale.
[[nodiscard]] FleetPrior prior_of(const FleetRow& row);

/// Adds the risks to every demand on a number with both sides of its interval for which the plan has a row: u is the
/// half-width on the side of the limit over 1.96, the acceptance limit that of the rule.
void add_fleet_risks(std::vector<Demand>& demands, const LimitsPlan& limits);

}  // namespace todbench
