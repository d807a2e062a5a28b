// SPDX-License-Identifier: GPL-3.0-or-later
// todbench watch
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_watch_command(CLI::App& app, Program& program);

}  // namespace todbench
