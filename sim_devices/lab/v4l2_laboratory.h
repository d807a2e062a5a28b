// SPDX-License-Identifier: GPL-3.0-or-later
// Emulated laboratory with a V4L2 camera.
#pragma once

#include <memory>

#include "sim_devices/lab/device_nodes/mock_system.h"
#include "sim_devices/lab/laboratory_camera.h"
#include "sim_devices/lab/video/video_frames.h"

namespace todbench {

/// Returns the sensor with the counts that a camera of this kind sends: 0.01 or 1/64 K per count from 0 K, 16 bits.
/// Kinds that do not report temperature keep the scale of the sensor.
[[nodiscard]] SensorSpec with_counts_of(VideoCameraKind kind, SensorSpec sensor);

/// Returns a function that plugs a camera into `system`. The sensor sets geometry and rate.
[[nodiscard]] ConnectCamera connect_v4l2(std::shared_ptr<MockSystem> system, VideoCameraConfig config);

}  // namespace todbench
