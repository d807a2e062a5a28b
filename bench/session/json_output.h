// The JSON objects that other programs rely on.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

/// The fit of `fit TRIALS.csv --json`.
[[nodiscard]] Json fit_json(const PsychometricFit& fit);
/// {"adequate", "findings": [{"kind", "value", "limit", "sentence", "unfit"}]} of a fit, a point or a comparison; null
/// where it was not examined.
[[nodiscard]] Json adequacy_json(const std::optional<Adequacy>& adequacy);

/// What `measure` and `simulate` say beside the curve.
struct RunFigures {
  double wall_s = 0;
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
};
/// "answers", "frames_per_presentation" and "answers_reason" of a point, null where nobody said.
void add_answers(Json& json, const TodPoint& point);
/// `measure PLAN --json` and `simulate PLAN --json`; the plan of a measured curve has no effects.
[[nodiscard]] Json curve_json(const TodCurve& curve, const SensorPlan& plan, const RunFigures& figures);

/// `compare A B --json`.
[[nodiscard]] Json comparison_json(const Comparison& comparison);

/// What `plan` predicts.
struct PlanFigures {
  std::uint64_t trials = 0;
  std::optional<double> predicted_uncertainty_percent;
  std::optional<double> predicted_s;                ///< of the simulation, on one core
  std::optional<double> predicted_measurement_s{};  ///< of the camera; left out of the JSON where there is none
};
/// `plan PLAN --json`.
[[nodiscard]] Json plan_json(const SensorPlan& plan, const PlanFigures& figures);
/// The list of effects in both.
[[nodiscard]] Json effects_json(const SensorPlan& plan);

}  // namespace todbench
