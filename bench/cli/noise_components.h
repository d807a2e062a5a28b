// SPDX-License-Identifier: GPL-3.0-or-later
// The seven noise components of a complete recording, without corrections.
#pragma once

#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// Treatment of a recording with a correction of the camera or a moving scene.
enum class AcrossCorrections { refuse, take };

/// `todbench noise RECORDING --components-only`: prints or writes the components; returns the exit code.
[[nodiscard]] int run_noise_components(Console& console, const std::string& recording, AcrossCorrections across);

}  // namespace todbench
