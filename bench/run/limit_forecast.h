// What the limits of a plan will say of good cameras, before anything is measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/core/result.h"
#include "bench/judgement/conformity.h"
#include "bench/judgement/fleet_prior.h"
#include "bench/plan/plan.h"
#include "bench/run/prediction.h"

namespace todbench {

/// One number of presentations.
struct LimitOutlook {
  double u_ln_acuity = 0;                  ///< of trials and stated budget
  double guard_band_ln = 0;                ///< of ln acuity, by the rule of the plan
  double p_rejected = 0;                   ///< that a camera with the acuity of the simulated sensor does not pass
  double passes_95_from_per_mrad = 0;      ///< a camera of this acuity or better passes with 95 %
  std::optional<GlobalRisks> fleet{};      ///< of a fleet around the simulated sensor, where the plan states its spread
  std::optional<FleetForecast> earlier{};  ///< of the fleet of earlier units, where the plan has its row
};

/// One limit on acuity.
struct LimitForecast {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  double expected_acuity_per_mrad = 0;  ///< of the simulated sensor
  LimitOutlook planned, fourfold;       ///< as planned, and with four times the presentations
};

/// Of every limit on acuity at whose contrast a threshold is expected. Errors: curve_uncertainty().
[[nodiscard]] Result<std::vector<LimitForecast>> limit_forecasts(const Plan& plan, const PlanPrediction& prediction);

/// One limit on a measure for which the plan has the row of a fleet, with the uncertainty of the values that the row
/// is of, and with half of it.
struct MeasureForecast {
  LimitedMeasure measure = LimitedMeasure::netd;
  std::optional<double> at_least{}, at_most{};
  double u = 0;
  FleetForecast as_before, half_u;
};
/// Of every limit on a measure whose row states an uncertainty; measures whose sign does not count are left out.
/// Errors: global_risks().
[[nodiscard]] Result<std::vector<MeasureForecast>> measure_forecasts(const LimitsPlan& limits);

/// "netd, at most 0.06: ..."
[[nodiscard]] std::string in_words(const MeasureForecast& forecast);

/// "16.9 K, at least 0.4 1/mrad: ..."
[[nodiscard]] std::string in_words(const LimitForecast& forecast);

}  // namespace todbench
