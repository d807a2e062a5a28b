// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory with a GigE Vision camera on plain sockets.
#pragma once

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the sensor with the counts that this model sends with settings for measurements: 0.04 K in 14 bits, or 0.01
/// K in 16. The sensor is unchanged for a model that sends raw counts.
[[nodiscard]] SensorSpec with_counts_of(CameraModel model, SensorSpec sensor);

/// Returns a function that connects the camera. The sensor sets geometry, rate and scale of the configuration.
[[nodiscard]] ConnectCamera connect_gvsp(GvspCameraConfig config);

}  // namespace todbench
