// SPDX-License-Identifier: GPL-3.0-or-later
// Operator at the terminal of the program.
#pragma once

#include "tod/presentation/operator_request.h"

namespace todbench {

/// Returns a function that writes requests to standard error and reads answers from standard input. Runs use this
/// function by default.
[[nodiscard]] AskOperator ask_at_terminal();

}  // namespace todbench
