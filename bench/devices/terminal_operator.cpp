// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/devices/terminal_operator.h"

#include <iostream>

#include "tod/instruments/operator_terminal.h"

namespace todbench {

AskOperator ask_at_terminal() {
  return operator_at_terminal(std::cerr, descriptor_lines(0));
}

}  // namespace todbench
