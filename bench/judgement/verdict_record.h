// SPDX-License-Identifier: GPL-3.0-or-later
// Verdict as JSON: verdict.json of a session, and key "judgement" of the JSON output.
#pragma once

#include "acquisition/base/result.h"
#include "bench/judgement/verdict.h"
#include "bench/text/json.h"

namespace todbench {

[[nodiscard]] Json verdict_json(const Verdict& verdict);
/// Parses a record. Errors: `invalid_input` with the key (incomplete record, wrong type, unknown word or unit).
[[nodiscard]] Result<Verdict> verdict_from(const Json& record);

}  // namespace todbench
