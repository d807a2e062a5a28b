// The measured frontier of accuracy and time as JSON: what `cost` prints and a session keeps.
#pragma once

#include "acquisition/core/result.h"
#include "bench/session/json_output.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// `cost PLAN --json`, and cost.json of a session.
[[nodiscard]] Json cost_json(const CostFrontier& frontier);
/// `invalid_input`, naming the key, for a record that is not complete or of other types.
[[nodiscard]] Result<CostFrontier> cost_from(const Json& record);

}  // namespace todbench
