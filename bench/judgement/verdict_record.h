// SPDX-License-Identifier: GPL-3.0-or-later
// Verdict as JSON: verdict.json of a session, and key "judgement" of the JSON output.
#pragma once

#include "acquisition/base/result.h"
#include "bench/judgement/verdict.h"
#include "bench/text/json.h"

namespace todbench {

/// Returns the key "judgement" of the JSON output.
[[nodiscard]] Json verdict_json(const Verdict& verdict);
/// Returns the content of verdict.json, with the same keys. Errors: those of json_of().
[[nodiscard]] Result<Json> verdict_record(const Verdict& verdict);
/// Parses a record. Errors: those of from_json(), also for a unit that differs from the unit of the kind.
[[nodiscard]] Result<Verdict> verdict_from(const Json& record);

}  // namespace todbench
