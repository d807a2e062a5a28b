// SPDX-License-Identifier: GPL-3.0-or-later
// Change of the target while the camera continues to send frames.
#pragma once

#include <stop_token>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Outcome of a change of the target, for the target and for the frames.
struct TargetChange {
  Result<PresentedTarget> presented;
  Result<void> frames;  ///< result for the frames taken in the meantime, if any
  /// The camera failed first, and the wait for the target was cancelled. The target's error is then only a consequence.
  bool given_up = false;
};

/// Presents a state and handles the frames sent in the meantime as RunController::frames_while_presenting() states. If
/// they are taken, a second thread takes them. A camera failure then ends the wait for the target, because a black body
/// may need minutes and the state has to be presented again anyway. Errors: only those of the host.
[[nodiscard]] Result<TargetChange> change_target(Target& target, FrameTaker& taker, RunController& host,
                                                 const TargetState& state, std::stop_token stop);

}  // namespace todbench
