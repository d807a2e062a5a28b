// SPDX-License-Identifier: GPL-3.0-or-later
// UVC and other kernel cameras through Video4Linux.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Options of v4l2_backend().
struct V4l2Options {
  /// PFNC name of the counts: "Mono16", "Mono14", "Mono8" ...; empty: the format with the most significant bits.
  std::string pixel_format;
  unsigned buffers = 8;  ///< shared with the driver; a receiving thread empties them immediately
};

/// Lists and opens cameras by identity, "v4l2:VENDOR-MODEL-SERIAL" from the USB device, or by their present node,
/// "v4l2:/dev/video2". A camera without a serial number is identified by its port. Y16, Y14, Y12, Y10 and GREY are
/// counts. YUYV is measured only if the camera sends temperatures in the rows below its picture (256 x 384 and
/// similar).
///
/// Features in addition to the controls of the driver: PixelFormat, Width, Height, AcquisitionFrameRate,
/// DeviceVendorName, DeviceModelName, DeviceSerialNumber, and TemperatureLinearScale and TemperatureLinearOffset
/// (kelvin per count, kelvin at count 0). The user sets the scale if the camera does not report it; setting it never
/// changes the camera.
[[nodiscard]] std::unique_ptr<CameraBackend> v4l2_backend(V4l2Options options = {});

}  // namespace todbench
