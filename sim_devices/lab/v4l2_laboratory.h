// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory with a V4L2 camera.
#pragma once

#include <memory>

#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

/// Returns the sensor with the counts that a camera of this kind sends. Kinds that report temperature have 0.01 or 1/64
/// K per count, 16 bits, and count 0 at 0 K. The other kinds keep the scale of the sensor and have as many bits as
/// their pixel format.
[[nodiscard]] SensorSpec with_counts_of(VideoCameraKind kind, SensorSpec sensor);

/// Returns a function that connects an emulated camera to the emulated USB and video devices of `system`. The sensor
/// argument determines frame size and rate. Its errors: those of EmulatedV4l2Camera::start().
[[nodiscard]] ConnectCamera connect_v4l2(std::shared_ptr<MockSystem> system, VideoCameraConfig config);

}  // namespace todbench
