// SPDX-License-Identifier: GPL-3.0-or-later
// todbench plate
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_plate_command(CLI::App& app, Program& program);

}  // namespace todbench
