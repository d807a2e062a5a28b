// SPDX-License-Identifier: GPL-3.0-or-later
// Changes the target while the camera continues to send frames.
#pragma once

#include <stop_token>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Result of a change of the target: result of present(), and result of taking frames.
struct TargetChange {
  Result<PresentedTarget> presented;
  Result<void> frames;  ///< result of taking frames during the change; success if no frames were taken
  /// True if the camera failed first and the wait for the target was cancelled. The error of the target is then only a
  /// consequence.
  bool given_up = false;
};

/// Presents a state. Frames that the camera sends during the change are treated as
/// RunController::frames_while_presenting() states. For FramesWhilePresenting::take, a second thread takes the frames.
/// A failure of the camera then ends the wait for the target, because a black body may need minutes to settle, and the
/// state must be presented again after the failure. Errors: only those of `host`.
[[nodiscard]] Result<TargetChange> change_target(Target& target, FrameTaker& taker, RunController& host,
                                                 const TargetState& state, std::stop_token stop);

}  // namespace todbench
