// SPDX-License-Identifier: GPL-3.0-or-later
// todbench scene-dependence
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_scene_dependence_command(CLI::App& app, Program& program);

}  // namespace todbench
