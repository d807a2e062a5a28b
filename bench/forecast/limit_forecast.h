// SPDX-License-Identifier: GPL-3.0-or-later
// Predicted verdicts on the limits of a plan, for cameras and fleets of known acuity, before anything is measured.
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
  double u_ln_acuity = 0;              ///< standard uncertainty of ln acuity from trials and stated budget
  double guard_band_ln = 0;            ///< guard band in ln acuity, by the rule of the plan
  double p_rejected = 0;               ///< risk that a camera with the acuity of the simulated sensor does not pass
  double passes_95_from_per_mrad = 0;  ///< a camera with at least this acuity passes with a probability of 95 %
  /// Risks in a fleet around the simulated sensor; present if the plan states the spread of the fleet.
  std::optional<GlobalRisks> fleet{};
  /// Risks in the fleet of earlier units; present if the plan contains the row of this fleet.
  std::optional<FleetForecast> earlier{};
};

/// Forecast of one limit on acuity.
struct LimitForecast {
  double delta_t_k = 0;
  double least_acuity_per_mrad = 0;
  double expected_acuity_per_mrad = 0;  ///< acuity of the simulated sensor
  LimitOutlook planned, fourfold;       ///< as planned, and with four times the presentations
};

/// Returns the curve that a prediction expects: thresholds and intervals, as curve_uncertainty() needs them.
[[nodiscard]] TodCurve expected_curve(const PlanPrediction& prediction);

/// Forecasts every limit on acuity at whose contrast a threshold is expected. Errors: those of curve_uncertainty().
[[nodiscard]] Result<std::vector<LimitForecast>> limit_forecasts(const Plan& plan, const PlanPrediction& prediction);

/// Forecast of one limit on a measure with a row in [[limits.fleet]]: with the standard uncertainty `u` of that row,
/// and with half of this uncertainty.
struct MeasureForecast {
  std::string measure;
  std::optional<double> at_least{}, at_most{};
  double u = 0;  ///< standard uncertainty in the unit of the measure
  FleetForecast as_before, half_u;
};
/// Returns a forecast for every limit on a measure whose fleet row states an uncertainty. Measures with limits on their
/// absolute value are left out. Errors: those of global_risks().
[[nodiscard]] Result<std::vector<MeasureForecast>> measure_forecasts(const LimitsPlan& limits);

/// Returns "netd, at most 0.06: ..."
[[nodiscard]] std::string in_words(const MeasureForecast& forecast);

/// Returns "16.9 K, at least 0.4 1/mrad: ..."
[[nodiscard]] std::string in_words(const LimitForecast& forecast);

}  // namespace todbench
