// Puts a thermal camera into the state in which it can be measured, and reads back what it became. Private to the
// Aravis back end.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/aravis/aravis_backend.h"
#include "acquisition/aravis/camera_families.h"
#include "acquisition/aravis/glib_ptr.h"
#include "acquisition/core/frame_source.h"
#include "acquisition/pixel_formats/pixel_formats.h"

namespace todbench {

/// What the camera sends.
struct StreamFormat {
  int width = 0, height = 0;
  PixelFormat pixel_format = PixelFormat::mono16;
  int significant_bits = 16;
  std::size_t payload_bytes = 0;
  bool big_endian = false;  ///< pixels arrive with the high byte first
  AravisTransport transport = AravisTransport::gige_vision;
};

/// The line of the table of families that this camera is.
[[nodiscard]] CameraFamily family_of(ArvDevice* device, const SourceInfo& info);

/// Makes the choices of the family and chooses the pixel format (`wanted`, or the best one when empty). Features that
/// the camera does not have are passed over; a refused one becomes a warning. Errors: `not_found` (no usable pixel
/// format, `wanted` refused), `disconnected`.
[[nodiscard]] Result<std::vector<std::string>> prepare_camera(ArvCamera* camera, const CameraFamily& family,
                                                              const std::string& wanted);

/// Geometry, format and payload as the camera states them now. At most 16384 x 16384 pixels and 64 MiB: what a camera
/// states decides how much memory is reserved, and a camera may state anything.
[[nodiscard]] Result<StreamFormat> read_stream_format(ArvCamera* camera);

/// The scale that the camera's present settings mean; uncalibrated when they do not say. Read back, never assumed.
/// IRFormat (FLIR A3xx ... A700): 0.01 or 0.1 K per count, or the radiometric formula with R, B, F, J0, J1 at unit
/// emissivity and transmission: T = B / ln(R J1 / (S - J0) + F). TemperatureLinearMode (FLIR Ax5): 0.04 or 0.4 K per
/// count, or the formula with R, B, F, O. Float features TemperatureLinearScale (K per count) and
/// TemperatureLinearOffset (K) take precedence over the names.
[[nodiscard]] RadiometricScale read_scale(ArvDevice* device, const CameraFamily& family);

/// Frames per second, 0 when the camera does not say.
[[nodiscard]] double read_frame_rate(ArvCamera* camera, const CameraFamily& family);

/// Everything that may influence a measurement, by feature name; what the camera does not have or refuses is left out.
/// `disconnected` at the first read that is not answered.
[[nodiscard]] Result<std::map<std::string, std::string>> read_settings(ArvDevice* device);

/// Commands that correct the non-uniformity, best first: those of the family, or by name where it has none.
[[nodiscard]] std::vector<std::string> nonuniformity_commands(ArvDevice* device, const CameraFamily& family);

/// Keeps the camera from correcting when it likes, so that only commands do; a sentence where it cannot be kept from
/// it. Errors: `disconnected`.
[[nodiscard]] Result<std::optional<std::string>> take_over_corrections(ArvDevice* device, const CameraFamily& family);

}  // namespace todbench
