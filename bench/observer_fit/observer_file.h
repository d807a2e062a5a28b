// SPDX-License-Identifier: GPL-3.0-or-later
// Parameter file of an observer fitted to people.
#pragma once

#include <string>

#include "bench/observer_fit/people_fit.h"

namespace todbench {

/// Returns the text of an observer description that plans can name. Its table [fit] states the origin: program,
/// parameters with intervals, correlations, and hashes of the sessions. The lapse rate is only in [fit], because the
/// template observer has no lapse rate.
[[nodiscard]] std::string observer_file(const PeopleFit& fit);

}  // namespace todbench
