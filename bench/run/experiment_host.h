// Who commands an experiment.
#pragma once

#include "bench/run/operator_target.h"
#include "bench/run/pause.h"

namespace todbench {

/// What decides how a run goes on, beside its plan. What only wants to know how it goes is an ExperimentListener.
struct ExperimentHost {
  /// Lets a run rest between two presentations; null: it never does. Outlives the run.
  const Pause* pause = nullptr;
  /// Answers a request to a target of kind prompt; none: the terminal.
  OperatorDialogue ask_operator{};
};

}  // namespace todbench
