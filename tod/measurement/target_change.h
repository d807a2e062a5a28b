// SPDX-License-Identifier: GPL-3.0-or-later
// Change of the target while the camera continues.
#pragma once

#include <stop_token>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/run_controller.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Outcome of a change of the target, for target and frames.
struct TargetChange {
  Result<PresentedTarget> presented;
  Result<void> frames;  ///< frames taken meanwhile, if any
  /// The camera failed first, and the wait for the target was cancelled: the target's error is then not a failure of
  /// its own.
  bool given_up = false;
};

/// Presents a state and handles the frames sent meanwhile as RunController::frames_while_presenting() states. If they
/// are taken, a second thread takes them, and a camera failure ends the wait for the target: a black body may need
/// minutes, and the state has to be presented again anyway. Errors: only those of the host.
[[nodiscard]] Result<TargetChange> change_target(Target& target, FrameTaker& taker, RunController& host,
                                                 const TargetState& state, std::stop_token stop);

}  // namespace todbench
