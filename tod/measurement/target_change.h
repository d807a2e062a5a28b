// The target changes while the camera goes on.
#pragma once

#include <stop_token>

#include "tod/measurement/frame_taker.h"
#include "tod/measurement/measurement_host.h"
#include "tod/presentation/target.h"

namespace todbench {

/// How a change of the target ended, for both who took part in it.
struct TargetChange {
  Result<PresentedTarget> presented;
  Result<void> frames;  ///< those that came meanwhile, where they were taken
  /// The camera failed first, and the target was told to wait no longer: what it says then is no failure of its own.
  bool given_up = false;
};

/// Presents a state; frames meanwhile as the host says. Where they are taken, a second thread takes them, and a camera
/// that fails ends the wait for the target: a black body may need minutes, and what it would settle for has to be
/// presented again anyway. Fails with what the host fails with, and with nothing else.
[[nodiscard]] Result<TargetChange> change_target(Target& target, FrameTaker& taker, MeasurementHost& host,
                                                 const TargetState& state, std::stop_token stop);

}  // namespace todbench
