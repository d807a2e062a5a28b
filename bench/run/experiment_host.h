// Who commands an experiment.
#pragma once

#include "bench/run/pause.h"
#include "bench/session/session_clock.h"
#include "tod/presentation/operator_request.h"

namespace todbench {

/// What decides how a run goes on, beside its plan. What only wants to know how it goes is an ExperimentListener.
struct ExperimentHost {
  /// Lets a run rest between two presentations; null: it never does. Outlives the run.
  const Pause* pause = nullptr;
  /// Answers a request to a target of kind prompt; none: the terminal.
  AskOperator ask_operator{};
  HostClocks clocks = host_clocks();
};

}  // namespace todbench
