// Puts a thermal camera into the state in which it can be measured, and reads back what it became. Private to the
// Aravis back end.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/frame_source.h"

namespace todbench {

/// What the camera sends.
struct StreamFormat {
  int width = 0, height = 0;
  std::string name;  ///< PFNC
  ArvPixelFormat code = 0;
  int significant_bits = 16;
  std::size_t payload_bytes = 0;
  bool big_endian = false;  ///< pixels arrive with the high byte first
};

/// Chooses the pixel format (`wanted`, or the best one when empty), linear temperature at the finest step, and switches
/// off whatever filters pixels in space or time. Features that the camera does not have are passed over; a refused one
/// becomes a warning. Errors: `not_found` (no usable pixel format, `wanted` refused), `disconnected`.
[[nodiscard]] Result<std::vector<std::string>> prepare_camera(ArvCamera* camera, const std::string& wanted);

/// Geometry, format and payload as the camera states them now.
[[nodiscard]] Result<StreamFormat> read_stream_format(ArvCamera* camera);

/// The scale that the camera's present settings mean; uncalibrated when they do not say. Read back, never assumed.
/// IRFormat (FLIR A3xx ... A700): 0.01 or 0.1 K per count, or the radiometric formula with R, B, F, J0, J1 at unit
/// emissivity and transmission: T = B / ln(R J1 / (S - J0) + F). TemperatureLinearMode (FLIR Ax5): 0.04 or 0.4 K per
/// count, or the formula with R, B, F, O. Float features TemperatureLinearScale (K per count) and
/// TemperatureLinearOffset (K) take precedence over the names.
[[nodiscard]] RadiometricScale read_scale(ArvDevice* device);

/// Frames per second, 0 when the camera does not say.
[[nodiscard]] double read_frame_rate(ArvCamera* camera);

/// Everything that may influence a measurement, by feature name.
[[nodiscard]] std::map<std::string, std::string> read_settings(ArvDevice* device);

/// Commands that correct the non-uniformity, best first.
[[nodiscard]] std::vector<std::string> nonuniformity_commands(ArvDevice* device);

}  // namespace todbench
