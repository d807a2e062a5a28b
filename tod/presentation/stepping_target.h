// SPDX-License-Identifier: GPL-3.0-or-later
// A target whose contrast steps while the camera records frames.
#pragma once

#include <stop_token>

#include "acquisition/base/result.h"

namespace todbench {

/// Additional interface of a Target whose steps begin on command and are instantaneous. For other targets, the step
/// occurs in present(), which returns after settling. Use it only from the thread of the Target.
class SteppingTarget {
 public:
  virtual ~SteppingTarget() = default;
  /// Steps from the presented state to a different contrast. The step occurs at a random time within the next frame,
  /// independent of the camera. Returns before the step. Errors: `invalid_input` (a contrast that the target cannot
  /// show), `interrupted`.
  [[nodiscard]] virtual Result<void> step_to(double delta_t_k, std::stop_token stop) = 0;
};

}  // namespace todbench
