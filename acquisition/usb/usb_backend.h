// SPDX-License-Identifier: GPL-3.0-or-later
// USB cameras with a vendor-specific protocol, through libusb: Seek Thermal Compact and CompactPRO.
#pragma once

#include <memory>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Lists and opens "usb:SEEK-MODEL-SERIAL", e.g. "usb:SEEK-CompactPRO-0A1B2C". The serial number comes from the USB
/// descriptors, or from the chip if they have none. Counts are picture - shutter picture + 16384 with dead pixels
/// filled (see seek_protocol.h). A user who calibrated the camera sets the features TemperatureLinearScale and
/// TemperatureLinearOffset. Shutter frames are delivered as frames during a non-uniformity correction, which the
/// integrity gate rejects. start() returns after about a dozen frames, stop() within milliseconds. An unplugged cable
/// is reported as `disconnected` immediately. Error of opening: `not_found` (absent, busy, or access denied).
[[nodiscard]] std::unique_ptr<CameraBackend> usb_backend();

}  // namespace todbench
