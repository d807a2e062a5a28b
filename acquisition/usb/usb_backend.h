// SPDX-License-Identifier: GPL-3.0-or-later
// USB cameras with a protocol of their own, through libusb: Seek Thermal Compact and CompactPRO.
#pragma once

#include <memory>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Lists and opens "usb:SEEK-MODEL-SERIAL", e.g. "usb:SEEK-CompactPRO-0A1B2C"; the serial number is that of the USB
/// descriptors, or that of the chip. Counts are picture - shutter picture + 16384 with dead pixels filled (see
/// seek_protocol.h). A user who calibrated the camera states TemperatureLinearScale and TemperatureLinearOffset as
/// settings. Shutter frames are delivered as frames during a non-uniformity correction, which the integrity gate
/// rejects. start() takes the time of a dozen frames, stop() milliseconds; an unplugged cable is `disconnected` at
/// once. Error of opening: `not_found` (absent, busy, or access denied).
[[nodiscard]] std::unique_ptr<CameraBackend> usb_backend();

}  // namespace todbench
