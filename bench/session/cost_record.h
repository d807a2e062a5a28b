// SPDX-License-Identifier: GPL-3.0-or-later
// Measured trade-off between accuracy and computing time (frontier) as JSON, as printed by `cost` and stored in a
// session.
#pragma once

#include "acquisition/base/result.h"
#include "bench/session/json_output.h"
#include "sim_devices/prediction/cost_frontier.h"

namespace todbench {

/// Returns the output of `cost PLAN --json` and the content of cost.json. Errors: those of json_of().
[[nodiscard]] Result<Json> cost_json(const CostFrontier& frontier);
/// Parses a record. Errors: `invalid_input` with the key (incomplete record, wrong type).
[[nodiscard]] Result<CostFrontier> cost_from(const Json& record);

}  // namespace todbench
