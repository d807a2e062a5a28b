// The budget of a session applied to its curve: uncertainty.json, and the key "uncertainty" on standard output.
#pragma once

#include "acquisition/core/result.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/text/json.h"

namespace todbench {

[[nodiscard]] Json uncertainty_json(const CurveUncertainty& uncertainty);
/// `invalid_input`, naming the key, for a record that is not complete or of other types.
[[nodiscard]] Result<CurveUncertainty> uncertainty_from(const Json& record);

/// Adds to the points of curve_json() their expanded intervals, and the whole under "uncertainty".
void add_uncertainty(Json& curve, const CurveUncertainty& uncertainty);

}  // namespace todbench
