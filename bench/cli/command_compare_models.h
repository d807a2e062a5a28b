// SPDX-License-Identifier: GPL-3.0-or-later
// todbench compare-models
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_compare_models_command(CLI::App& app, Program& program);

}  // namespace todbench
