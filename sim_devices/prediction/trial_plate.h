// The plate that trials without a plan show: four orientations of every size, and marks for the registration.
#pragma once

#include <vector>

#include "sim_devices/sensor/sensor_spec.h"
#include "tod/plate/target_plate.h"

namespace todbench {

/// At this distance a millimetre is a milliradian.
inline constexpr double trial_distance_m = 1;

/// Four orientations of every size in turn, triangle t of size t / 4, two sizes in a row, in cells so wide that no
/// window sees a neighbour; behind them four large triangles of the same contrast, above and below, for the
/// registration what the edges of a plate are. Precondition: a size.
[[nodiscard]] TargetPlate trial_plate(const std::vector<double>& sizes_pitch, double ifov_mrad);

/// The part of the camera that the plate fills, and `margin_px` on every side: pixels that no window looks at cost time
/// only.
[[nodiscard]] SensorSpec cropped_to(SensorSpec sensor, const TargetPlate& plate, int margin_px);

}  // namespace todbench
