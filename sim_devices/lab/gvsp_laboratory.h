// The emulated laboratory with a GigE Vision camera on plain sockets.
#pragma once

#include "sim_devices/lab/gige/gvsp_camera.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/sensor/sensor_spec.h"

namespace todbench {

/// The sensor with counts as this model sends them when it is set up for measuring: 0.04 K in 14 bits, or 0.01 K in 16.
/// A model that sends raw counts leaves the sensor as it is.
[[nodiscard]] SensorSpec with_counts_of(CameraModel model, SensorSpec sensor);

/// Geometry, rate and scale of the configuration are filled in from the sensor.
[[nodiscard]] ConnectCamera connect_gvsp(GvspCameraConfig config);

}  // namespace todbench
