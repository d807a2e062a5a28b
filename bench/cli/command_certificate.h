// SPDX-License-Identifier: GPL-3.0-or-later
// todbench certificate
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_certificate_command(CLI::App& app, Program& program);

}  // namespace todbench
