// SPDX-License-Identifier: GPL-3.0-or-later
// Host that controls an experiment.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/result.h"
#include "bench/devices/pause.h"
#include "bench/session/session_clock.h"
#include "sim_devices/module/picture_stage.h"
#include "tod/measurement/measurement.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

struct OpenedBench;

/// Stages of an enhancement package, after the modules of the plan. The stages process the frames of the camera and of
/// its twin.
struct AddedStages {
  /// Creates the stages and passes on lines of their standard error. Empty: no stages.
  std::function<std::vector<std::unique_ptr<ChainStage>>(const std::function<void(std::string_view line)>&)> make{};
  int dither = 1;  ///< n: the twin observes n x n positions within a pixel in sequence, as the recorded stage did
  int memory_frames = 0;  ///< exposures of the twin that are discarded after a change of the target
  /// Sets the options of the recorded run. These options are required because a recording replays only the questions of
  /// that run. The answers are then reduced to binary answers. Empty: no recorded run.
  std::function<void(MeasurementOptions& camera)> as_recorded{};
};

/// Repeated attempts to open a camera that is not available yet.
struct CameraPatience {
  std::chrono::milliseconds longest{0};  ///< longest time from the call; 0: one attempt
  std::chrono::milliseconds between_attempts{500};
  std::function<void(const Error& reason)> on_waiting{};  ///< called after each failed attempt except the last
};

/// Controls of a run beyond its plan. An ExperimentListener only receives progress.
struct ExperimentHost {
  /// Lets a run pause between two presentations; null: the run never pauses. Must outlive the run.
  const Pause* pause = nullptr;
  /// Passes requests of a target of kind prompt to the operator; empty: at the terminal.
  AskOperator ask_operator{};
  /// Attempts to open a camera that is not available yet.
  CameraPatience camera_patience{};
  HostClocks clocks = host_clocks();
  AddedStages added{};
  /// Changes or refuses the opened devices before the run, and returns a note about the change for the session. Empty:
  /// the devices are used as opened.
  std::function<Result<std::string>(OpenedBench& bench)> on_opened{};
};

}  // namespace todbench
