// todbench identify
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_identify_command(CLI::App& app, Program& program);

}  // namespace todbench
