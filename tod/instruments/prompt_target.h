// SPDX-License-Identifier: GPL-3.0-or-later
// A manual bench. The operator is asked for each change, and the program waits until the change is done.
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
  /// Clock for settling_s, which for this target is the time that the operator needed.
  std::function<std::chrono::steady_clock::time_point()> now = [] { return std::chrono::steady_clock::now(); };
};

/// Returns a target whose present() asks the operator for the changes since the last state and waits for the answer.
/// PresentedTarget::state is the requested state; it is not verified and has no temperatures. sets_shift is false. For
/// a new shift, the operator is asked to move the plate slightly, and registration measures the actual shift. If the
/// answer is `stop`, the error is `interrupted`. After any failure, the next request contains the complete state.
[[nodiscard]] std::unique_ptr<Target> prompt_target(AskOperator ask, PromptTargetOptions options = {});

}  // namespace todbench
