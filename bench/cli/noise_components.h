// The seven noise components of a whole recording as it is.
#pragma once

#include <string>

#include "bench/cli/console.h"

namespace todbench {

/// What to do with a recording in which the camera corrected itself, or the scene moved.
enum class AcrossCorrections { refuse, take };

/// `todbench noise RECORDING --components-only`: prints or writes them; the exit code.
[[nodiscard]] int run_noise_components(Console& console, const std::string& recording, AcrossCorrections across);

}  // namespace todbench
