// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim_devices/sensor/moving_scene.h"

#include <cmath>
#include <numbers>

#include "sim_devices/sensor/effect_exposure.h"

namespace todbench {

PlateScene in_motion(PlateScene scene, double speed_mm_s, const SensorSpec& spec) {
  if (speed_mm_s == 0) return scene;
  const double angle = scene.rotation_deg * std::numbers::pi / 180, speed_mrad_s = speed_mm_s / scene.distance_m;
  scene.motion = {.x_mrad_s = speed_mrad_s * std::cos(angle), .y_mrad_s = speed_mrad_s * std::sin(angle)};
  scene.centre_px -= mean_lag_pitch(spec, scene.motion) * spec.samples_per_pitch();
  return scene;
}

}  // namespace todbench
