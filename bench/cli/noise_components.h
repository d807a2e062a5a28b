// SPDX-License-Identifier: GPL-3.0-or-later
// Seven noise components of a complete recording, without corrections.
#pragma once

#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// Treatment of a recording that contains a correction of the camera (NUC) or a moving scene.
enum class AcrossCorrections { refuse, take };

/// Runs `todbench noise RECORDING --components-only`: prints or writes the components. Returns the exit code.
[[nodiscard]] int run_noise_components(Console& console, const std::string& recording, AcrossCorrections across);

}  // namespace todbench
