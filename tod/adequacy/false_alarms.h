// How often chance may look like a wrong model.
#pragma once

namespace todbench {

/// Probability that chance exceeds a limit.
struct FalseAlarms {
  double departure = 0, lapse = 0;
  double scatter = 0;  ///< on each side
};

}  // namespace todbench
