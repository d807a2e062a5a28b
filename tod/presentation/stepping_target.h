// A target whose contrast steps while the camera looks on.
#pragma once

#include <stop_token>

#include "acquisition/core/result.h"

namespace todbench {

/// What a Target is too, where it can say that a step begins now and is over at once. Where it cannot, present() makes
/// the step and comes back when it has settled. One thread at a time, that of the Target.
class SteppingTarget {
 public:
  virtual ~SteppingTarget() = default;
  /// Steps from the presented state to another contrast at a moment within the next frame, which the camera does not
  /// know; returns before it. Errors: `invalid_input` (a contrast that it cannot show), `interrupted`.
  [[nodiscard]] virtual Result<void> step_to(double delta_t_k, std::stop_token stop) = 0;
};

}  // namespace todbench
