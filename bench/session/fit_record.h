// Curves and comparisons as complete JSON records: what is written can be read back as the same values.
#pragma once

#include "acquisition/core/result.h"
#include "bench/session/json_output.h"

namespace todbench {

/// Every field of a curve, counts per size included.
[[nodiscard]] Json curve_record(const TodCurve& curve);
/// `invalid_input`, naming the key, for a record that is not complete or of other types.
[[nodiscard]] Result<TodCurve> curve_from(const Json& record);

/// Every field of a comparison; its keys contain those of comparison_json().
[[nodiscard]] Json comparison_record(const Comparison& comparison);
[[nodiscard]] Result<Comparison> comparison_from(const Json& record);

/// Every field of a plan of effects; the keys of effects_json().
[[nodiscard]] Result<SensorPlan> effects_from(const Json& effects);

}  // namespace todbench
