// UVC and other kernel cameras through Video4Linux.
#pragma once

#include <memory>
#include <string>

#include "acquisition/core/camera_registry.h"

namespace todbench {

struct V4l2Options {
  /// PFNC name of the counts: "Mono16", "Mono14", "Mono8" ...; empty: the format that carries the most.
  std::string pixel_format;
  unsigned buffers = 8;  ///< shared with the driver; a receiving thread empties them at once
};

/// Cameras by identity, "v4l2:VENDOR-MODEL-SERIAL" as the USB device tells it, or by where they are now,
/// "v4l2:/dev/video2". A camera without serial number is told by its port. Y16, Y14, Y12, Y10 and GREY are counts;
/// YUYV is measured only of cameras that send temperatures below their picture (256 x 384 and the like).
///
/// Features beside the controls of the driver: PixelFormat, Width, Height, AcquisitionFrameRate,
/// DeviceVendorName, DeviceModelName, DeviceSerialNumber, and TemperatureLinearScale and TemperatureLinearOffset:
/// kelvin per count and kelvin at count 0. Setting the scale states what the camera does not tell; it never changes the
/// camera.
[[nodiscard]] std::unique_ptr<CameraBackend> v4l2_backend(V4l2Options options = {});

}  // namespace todbench
