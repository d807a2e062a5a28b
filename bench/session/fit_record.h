// SPDX-License-Identifier: GPL-3.0-or-later
// Fits, curves and comparisons as JSON: objects for other programs, and complete records that can be read back without
// loss.
#pragma once

#include <optional>

#include "acquisition/base/result.h"
#include "bench/text/json.h"
#include "sim_devices/sensor/sensor_plan.h"
#include "tod/comparison/comparison.h"
#include "tod/psychometric/psychometric_fit.h"
#include "tod/psychometric/tod_curve.h"

namespace todbench {

class JsonFields;

/// Returns the output of `fit TRIALS.csv --json`.
[[nodiscard]] Json fit_json(const PsychometricFit& fit);
/// Returns {"adequate", "findings": [{"kind", "value", "limit", "sentence", "unfit"}]} of a fit, a point or a
/// comparison; null if it was not tested.
[[nodiscard]] Json adequacy_json(const std::optional<Adequacy>& adequacy);
/// Returns the output of `compare A B --json`.
[[nodiscard]] Json comparison_json(const Comparison& comparison);
/// Returns the list of effects in the JSON of curve and plan.
[[nodiscard]] Json effects_json(const SensorPlan& plan);

/// Returns every field of a curve, including counts per size. Errors: those of json_of().
[[nodiscard]] Result<Json> curve_record(const TodCurve& curve);
/// Parses a record. Errors: those of from_json().
[[nodiscard]] Result<TodCurve> curve_from(const Json& record);

/// Content of fits.json.
struct StoredCurves {
  std::optional<TodCurve> main;
  std::optional<TodCurve> twin;
};
/// Returns the content of fits.json. Errors: those of json_of().
[[nodiscard]] Result<Json> curves_record(const StoredCurves& curves);
/// Parses a record. Errors: those of from_json().
[[nodiscard]] Result<StoredCurves> curves_from(const Json& record);

/// Returns all fields of a comparison, including those of comparison_json(). Errors: those of json_of().
[[nodiscard]] Result<Json> comparison_record(const Comparison& comparison);
/// Parses a record. Errors: those of from_json().
[[nodiscard]] Result<Comparison> comparison_from(const Json& record);

/// Describes the key "effects" of a record, with the list of effects_json().
void effects_fields(JsonFields& json, SensorPlan& plan);

}  // namespace todbench
