// The parameter file of an observer that was fitted to people.
#pragma once

#include <string>

#include "bench/observer_fit/people_fit.h"

namespace todbench {

/// A description of an observer as plans name it, with a table [fit] that says where it comes from: program, parameters
/// with intervals, correlations, and the hashes of the sessions. The lapse stands there only: the template observer has
/// none.
[[nodiscard]] std::string observer_file(const PeopleFit& fit);

}  // namespace todbench
