// A plate that a stage moves, as a sensor sees it.
#pragma once

#include "sim_devices/scene/plate_scene.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The scene of a plate that is in its place and moves along its own x at `speed_mm_s`: smeared by time constant and
/// exposure, and behind its place by their mean lag, which image formation has taken out. At rest: the scene as it is.
[[nodiscard]] PlateScene in_motion(PlateScene scene, double speed_mm_s, const SensorSpec& spec);

}  // namespace todbench
