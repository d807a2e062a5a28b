// SPDX-License-Identifier: GPL-3.0-or-later
// The host that controls an experiment.
#pragma once

#include "bench/run/pause.h"
#include "bench/session/session_clock.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

/// Controls of a run beyond its plan. An ExperimentListener only receives progress.
struct ExperimentHost {
  /// Lets a run pause between two presentations; null: it never pauses. Outlives the run.
  const Pause* pause = nullptr;
  /// Answers the requests of a target of kind prompt; empty: asks at the terminal.
  AskOperator ask_operator{};
  HostClocks clocks = host_clocks();
};

}  // namespace todbench
