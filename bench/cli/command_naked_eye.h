// SPDX-License-Identifier: GPL-3.0-or-later
// todbench observer naked-eye
#pragma once

#include "bench/cli/commands.h"

namespace todbench {

void add_naked_eye_command(CLI::App& observer, Program& program);

}  // namespace todbench
