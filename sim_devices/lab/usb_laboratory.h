// The emulated laboratory with a USB camera in it: USB3 Vision, or a Seek.
#pragma once

#include <memory>

#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/usb/seek_camera.h"
#include "sim_devices/lab/usb/u3v_camera.h"

namespace todbench {

/// Plugs a USB3 Vision camera into `system`; geometry, rate and scale are filled in from the sensor.
[[nodiscard]] ConnectCamera connect_u3v(std::shared_ptr<MockSystem> system, U3vCameraConfig config);

/// Plugs a Seek camera into `system`; the rate is filled in from the sensor. Errors: `invalid_input` for a sensor that
/// has not the model's geometry, or more than 14 bits.
[[nodiscard]] ConnectCamera connect_seek(std::shared_ptr<MockSystem> system, SeekCameraConfig config);

}  // namespace todbench
