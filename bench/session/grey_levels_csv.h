// Contrasts in grey levels, frame by frame, as CSV.
#pragma once

#include <string>
#include <vector>

#include "tod/measurement/grey_levels.h"

namespace todbench {

/// One row for every frame that was judged, in the order of the run, below a header with units.
[[nodiscard]] std::string grey_levels_csv(const std::vector<GreyFrame>& frames);

}  // namespace todbench
