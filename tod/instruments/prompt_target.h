// A bench with a hand only: tells the operator what to do and waits until it is done.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "tod/presentation/operator_request.h"
#include "tod/presentation/target.h"

namespace todbench {

struct PromptTargetOptions {
  /// What the operator operates, for the report.
  std::string description = "set by hand by the operator";
  /// Time base of settling_s, which is here the time the operator took.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// present() asks for what has to change since the last state, waits for the answer and believes it:
/// PresentedTarget::state is the state asked for, without temperatures. sets_shift is false: a new shift asks for a
/// slight movement, and how far it went is for the registration to measure. The answer `stop` is `interrupted`; after
/// any failure the next request states everything again.
[[nodiscard]] std::unique_ptr<Target> prompt_target(AskOperator ask, PromptTargetOptions options = {});

}  // namespace todbench
