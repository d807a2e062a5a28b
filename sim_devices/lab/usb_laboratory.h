// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory with a USB camera: USB3 Vision, or a Seek.
#pragma once

#include <memory>

#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/usb/seek_camera.h"
#include "sim_devices/lab/usb/u3v_camera.h"

namespace todbench {

/// Returns a function that plugs a USB3 Vision camera into `system`. The sensor sets geometry, rate and scale.
[[nodiscard]] ConnectCamera connect_u3v(std::shared_ptr<MockSystem> system, U3vCameraConfig config);

/// Returns a function that plugs a Seek camera into `system`. The sensor sets the rate. Errors of the function:
/// `invalid_input` (a sensor without the model's geometry, or with more than 14 bits).
[[nodiscard]] ConnectCamera connect_seek(std::shared_ptr<MockSystem> system, SeekCameraConfig config);

}  // namespace todbench
