// Cameras with a protocol of their own on USB, through libusb: Seek Thermal Compact and CompactPRO.
#pragma once

#include <memory>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Lists and opens "usb:SEEK-MODEL-SERIAL", e.g. "usb:SEEK-CompactPRO-0A1B2C". The serial number is the one in the USB
/// descriptors, or the chip's. Frames are counts: picture less shutter picture plus 16384, dead pixels filled (see
/// seek_protocol.h); a user who calibrated the camera states TemperatureLinearScale and TemperatureLinearOffset as
/// settings. Shutter frames are handed out as frames during a non-uniformity correction, which the integrity gate
/// rejects. start() takes the time of a dozen frames; stop() milliseconds; a pulled cable is `disconnected` at once.
/// Opening fails with `not_found`: absent, busy, or access denied.
[[nodiscard]] std::unique_ptr<CameraBackend> usb_backend();

}  // namespace todbench
