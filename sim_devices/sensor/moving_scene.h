// SPDX-License-Identifier: GPL-3.0-or-later
// A plate on a moving stage, as a sensor observes it.
#pragma once

#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the scene of a plate that moves along its own x at `speed_mm_s`. Time constant and exposure smear the scene.
/// The scene is shifted back by their mean lag, because image formation removes the mean lag. At rest the scene is
/// unchanged.
[[nodiscard]] PlateScene in_motion(PlateScene scene, double speed_mm_s, const SensorSpec& spec);

}  // namespace todbench
