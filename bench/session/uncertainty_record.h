// SPDX-License-Identifier: GPL-3.0-or-later
// Uncertainty of the curve of a session by its budget: uncertainty.json, and key "uncertainty" of the JSON output.
#pragma once

#include "acquisition/base/result.h"
#include "bench/judgement/acuity_uncertainty.h"
#include "bench/text/json.h"

namespace todbench {

/// Returns the content of uncertainty.json. Errors: those of json_of().
[[nodiscard]] Result<Json> uncertainty_record(const CurveUncertainty& uncertainty);
/// Parses a record. Errors: those of from_json().
[[nodiscard]] Result<CurveUncertainty> uncertainty_from(const Json& record);

/// Adds the expanded intervals to the points of curve_json(), and the complete record as "uncertainty".
void add_uncertainty(Json& curve, const CurveUncertainty& uncertainty);

}  // namespace todbench
