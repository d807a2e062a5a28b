// SPDX-License-Identifier: GPL-3.0-or-later
// What the effects of a sensor are shown.
#pragma once

#include "sim_devices/sensor/sensor_model.h"

namespace todbench::test {

/// One triangle that moves, 9 mm large, pointing right.
inline PlateScene scene(double delta_t_k = 3) {
  PlateScene out;
  out.plate.name = "one";
  out.plate.triangles = {{.name = "only", .position_mm = {10, -8}, .size_mm = 9, .apex = Apex::right}};
  out.delta_t_k = delta_t_k;
  out.motion = {.x_mrad_s = 60, .y_mrad_s = -20};
  return out;
}

}  // namespace todbench::test
