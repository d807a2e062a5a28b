// The operator at the terminal of the program.
#pragma once

#include "tod/presentation/operator_request.h"

namespace todbench {

/// Writes requests to standard error and reads the answers from standard input; what a run without another host does.
[[nodiscard]] AskOperator ask_at_terminal();

}  // namespace todbench
