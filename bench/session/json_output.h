// SPDX-License-Identifier: GPL-3.0-or-later
// JSON objects for other programs.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// Figures of a run that `measure` and `simulate` report together with the curve.
struct RunFigures {
  double wall_s = 0;
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
  double measures_s = 0;                                 ///< part of wall_s: physical measures
};
/// Returns the output of `measure PLAN --json` and `simulate PLAN --json`. `plan` has no effects for a measured curve.
[[nodiscard]] Json curve_json(const TodCurve& curve, const SensorPlan& plan, const RunFigures& figures);

/// Predictions of the command `plan`.
struct PlanFigures {
  std::uint64_t trials = 0;
  std::optional<double> predicted_uncertainty_percent;
  std::optional<double> predicted_s;                ///< predicted time of the simulation on one core
  std::optional<double> predicted_measurement_s{};  ///< predicted time of the camera; omitted in the JSON if empty
};
/// Returns the output of `plan PLAN --json`.
[[nodiscard]] Json plan_json(const SensorPlan& plan, const PlanFigures& figures);

}  // namespace todbench
