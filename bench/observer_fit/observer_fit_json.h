// SPDX-License-Identifier: GPL-3.0-or-later
// Output of `observer fit --json`.
#pragma once

#include "bench/observer_fit/people_fit.h"
#include "bench/text/json.h"

namespace todbench {

/// Returns an object with the keys "observer", "from", "free", "estimates", "correlations", "goodness", "accepted",
/// "not_identified", "persons", "between_persons".
[[nodiscard]] Json people_fit_json(const PeopleFit& fit);

}  // namespace todbench
