// SPDX-License-Identifier: GPL-3.0-or-later
// Plate for trials without a plan: four orientations of every size, and marks for the registration.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// At this distance a millimetre is a milliradian.
inline constexpr double trial_distance_m = 1;

/// Four orientations of every size in turn, triangle t of size t / 4, two sizes in a row. Cells are wide enough that no
/// window contains a neighbour. They are followed by four large triangles of the same contrast, above and below, which
/// serve the registration like the edges of a plate. Precondition: at least one size.
[[nodiscard]] TargetPlate trial_plate(const std::vector<double>& sizes_pitch, double ifov_mrad);

/// The part of the camera that the plate fills, with `margin_px` on every side. Pixels outside all windows only take
/// time.
[[nodiscard]] SensorSpec cropped_to(SensorSpec sensor, const TargetPlate& plate, int margin_px);

}  // namespace todbench
