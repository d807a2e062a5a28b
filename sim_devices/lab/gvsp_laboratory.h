// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory with a GigE Vision camera on plain sockets.
#pragma once

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// Returns the sensor with the counts that this model sends with settings for measurements: 14 bits of 0.04 K (ax5), or
/// 16 bits of 0.01 K. For a model that sends raw counts (unlisted), the sensor is unchanged.
[[nodiscard]] SensorSpec with_counts_of(CameraModel model, SensorSpec sensor);

/// Returns a function that connects the camera. The sensor sets geometry, rate and scale in `config`.
[[nodiscard]] ConnectCamera connect_gvsp(GvspCameraConfig config);

}  // namespace todbench
