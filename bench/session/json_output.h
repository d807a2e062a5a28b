// The JSON objects that other programs rely on. A value that does not exist is null; NaN and infinity are never
// written.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "sim_devices/sensor/sensor_plan.h"
#include "tod/comparison.h"
#include "tod/psychometric_fit.h"
#include "tod/tod_curve.h"

namespace todbench {

/// Keys in the order in which they are added.
using Json = nlohmann::ordered_json;

/// The number, or null when it is missing or not finite.
[[nodiscard]] Json json_number(double value);
[[nodiscard]] Json json_number(const std::optional<double>& value);
/// [low, high], each side null where it is open.
[[nodiscard]] Json json_interval(const Interval& interval);
/// One line of text; invalid UTF-8 is replaced, nothing throws.
[[nodiscard]] std::string to_line(const Json& json);
/// The same over several lines, for files.
[[nodiscard]] std::string to_page(const Json& json);

/// Acuity in 1/mrad: 1 / threshold in mrad; nothing where there is no positive threshold.
[[nodiscard]] std::optional<double> acuity_per_mrad(const PsychometricFit& fit);
/// The interval of 1 / S75: the sides change places. A lower limit of 0 is none.
[[nodiscard]] Interval acuity_interval(const Interval& s75_mrad);

/// `fit TRIALS.csv --json`.
[[nodiscard]] Json fit_json(const PsychometricFit& fit);

/// What `measure` and `simulate` say beside the curve.
struct RunFigures {
  double wall_s = 0;
  std::uint64_t frames_used = 0;
  std::map<std::string, std::uint64_t> frames_rejected;  ///< by reason
};
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
