// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and comparisons as complete JSON records that read back to equal values.
#pragma once

#include "acquisition/base/result.h"
#include "bench/session/json_output.h"

namespace todbench {

/// Returns every field of a curve, including counts per size.
[[nodiscard]] Json curve_record(const TodCurve& curve);
/// Parses a record. Errors: `invalid_input` with the key (incomplete record, wrong type).
[[nodiscard]] Result<TodCurve> curve_from(const Json& record);

/// Returns every field of a comparison; the keys include those of comparison_json().
[[nodiscard]] Json comparison_record(const Comparison& comparison);
[[nodiscard]] Result<Comparison> comparison_from(const Json& record);

/// Parses a plan of effects with the keys of effects_json().
[[nodiscard]] Result<SensorPlan> effects_from(const Json& effects);

}  // namespace todbench
