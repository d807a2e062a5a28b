// SPDX-License-Identifier: GPL-3.0-or-later
// todbench module
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_module_command(CLI::App& app, Program& program);

}  // namespace todbench
