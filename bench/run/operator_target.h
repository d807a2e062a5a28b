// A target changed by hand, whose operator is asked by a window and not on a terminal.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include "tod/instruments/prompt_target.h"

namespace todbench {

/// Shows a request and returns the answer: an empty line for "done", "q" to end. Called from the thread of the run;
/// returns with `interrupted` as soon as stop is requested.
using OperatorDialogue = std::function<Result<std::string>(const std::string& request, const std::stop_token& stop)>;

/// prompt_target() that speaks through a dialogue.
[[nodiscard]] std::unique_ptr<Target> dialogue_target(OperatorDialogue ask, PromptTargetOptions options);

}  // namespace todbench
