// SPDX-License-Identifier: GPL-3.0-or-later
// todbench blind
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_blind_command(CLI::App& app, Program& program);

}  // namespace todbench
