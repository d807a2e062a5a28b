// SPDX-License-Identifier: GPL-3.0-or-later
// Plate for trials without a plan: four orientations of every size, and marks for the registration.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// Distance at which a millimetre is a milliradian.
inline constexpr double trial_distance_m = 1;

/// Returns a plate with four orientations of every size, size by size (triangle t has size number t / 4), two sizes in
/// a row. The cells are so wide that no window contains a neighbour. Four large triangles of the same contrast follow,
/// two above and two below the rows, as marks for the registration. Precondition: at least one size.
[[nodiscard]] TargetPlate trial_plate(const std::vector<double>& sizes_pitch, double ifov_mrad);

/// Returns the sensor cropped to the plate, with `margin_px` on every side and without distortion. The cropped pixels
/// lie outside all windows and would only cost time.
[[nodiscard]] SensorSpec cropped_to(SensorSpec sensor, const TargetPlate& plate, int margin_px);

}  // namespace todbench
