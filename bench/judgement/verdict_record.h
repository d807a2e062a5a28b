// A verdict as JSON: verdict.json of a session, and the key "judgement" on standard output.
#pragma once

#include "acquisition/core/result.h"
#include "bench/judgement/verdict.h"
#include "bench/text/json.h"

namespace todbench {

[[nodiscard]] Json verdict_json(const Verdict& verdict);
/// `invalid_input`, naming the key, for a record that is not complete, of other types, or with a word or unit that is
/// not known.
[[nodiscard]] Result<Verdict> verdict_from(const Json& record);

}  // namespace todbench
