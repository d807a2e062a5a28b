// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted verdicts of the limits of a plan on good cameras, before anything is measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/forecast/prediction.h"
#include "bench/judgement/conformity.h"
#include "bench/judgement/fleet_prior.h"
#include "bench/plan/plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Forecast for one number of presentations.
struct LimitOutlook {
  double u_ln_acuity = 0;                  ///< of trials and stated budget
  double guard_band_ln = 0;                ///< of ln acuity, by the rule of the plan
  double p_rejected = 0;                   ///< risk that a camera with the acuity of the simulated sensor does not pass
  double passes_95_from_per_mrad = 0;      ///< a camera with at least this acuity passes with a probability of 95 %
  std::optional<GlobalRisks> fleet{};      ///< of a fleet around the simulated sensor, if the plan states its spread
  std::optional<FleetForecast> earlier{};  ///< of the fleet of earlier units, if the plan has its row
};

/// Forecast of one limit on acuity.
struct LimitForecast {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  double expected_acuity_per_mrad = 0;  ///< of the simulated sensor
  LimitOutlook planned, fourfold;       ///< as planned, and with four times the presentations
};

/// Returns the expected curve, with the data that a budget needs.
[[nodiscard]] TodCurve expected_curve(const PlanPrediction& prediction);

/// Forecasts every limit on acuity at whose contrast a threshold is expected. Errors: those of curve_uncertainty().
[[nodiscard]] Result<std::vector<LimitForecast>> limit_forecasts(const Plan& plan, const PlanPrediction& prediction);

/// Forecast of one limit on a measure for which the plan has the row of a fleet: with the uncertainty of the row's
/// values, and with half of it.
struct MeasureForecast {
  std::string measure;
  std::optional<double> at_least{}, at_most{};
  double u = 0;
  FleetForecast as_before, half_u;
};
/// Returns a forecast for every limit on a measure whose row states an uncertainty; measures whose sign is ignored are
/// left out. Errors: those of global_risks().
[[nodiscard]] Result<std::vector<MeasureForecast>> measure_forecasts(const LimitsPlan& limits);

/// "netd, at most 0.06: ..."
[[nodiscard]] std::string in_words(const MeasureForecast& forecast);

/// "16.9 K, at least 0.4 1/mrad: ..."
[[nodiscard]] std::string in_words(const LimitForecast& forecast);

}  // namespace todbench
