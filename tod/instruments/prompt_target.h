// SPDX-License-Identifier: GPL-3.0-or-later
// A manual bench: asks the operator for each change and waits until it is done.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "tod/presentation/operator_request.h"
#include "tod/presentation/target.h"

namespace todbench {

/// Options of prompt_target().
struct PromptTargetOptions {
  /// Description of the manual equipment, for the report.
  std::string description = "set by hand by the operator";
  /// Time base of settling_s, which here is the time that the operator took.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Returns a target whose present() requests the changes since the last state and waits for the answer.
/// PresentedTarget::state is the requested state, unchecked and without temperatures. sets_shift is false: for a new
/// shift the operator is asked for a slight movement, and registration measures it. The answer `stop` results in
/// `interrupted`. After any failure the next request states the complete state again.
[[nodiscard]] std::unique_ptr<Target> prompt_target(AskOperator ask, PromptTargetOptions options = {});

}  // namespace todbench
