// SPDX-License-Identifier: GPL-3.0-or-later
// Puts a thermal camera into a measurable state and reads the result back. Private to the Aravis back end.
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

/// Geometry, format and payload of the camera's frames.
struct StreamFormat {
  int width = 0, height = 0;
  PixelFormat pixel_format = PixelFormat::mono16;
  int significant_bits = 16;
  std::size_t payload_bytes = 0;
  bool big_endian = false;  ///< pixels arrive with the high byte first
  AravisTransport transport = AravisTransport::gige_vision;
};

/// Returns the camera's family.
[[nodiscard]] CameraFamily family_of(ArvDevice* device, const SourceInfo& info);

/// Applies the settings of the family and sets the pixel format (`wanted`; empty: the best format). Features that the
/// camera lacks are skipped. Returns a warning for each feature that the camera refuses. Errors: `not_found` (no usable
/// pixel format, `wanted` refused), `disconnected`.
[[nodiscard]] Result<std::vector<std::string>> prepare_camera(ArvCamera* camera, const CameraFamily& family,
                                                              const std::string& wanted);

/// Reads the present geometry, format and payload. Errors: `not_found` (impossible, or above 16384 x 16384 pixels or 64
/// MiB, because memory is allocated by these unverified numbers; unknown pixel format), `disconnected`.
[[nodiscard]] Result<StreamFormat> read_stream_format(ArvCamera* camera);

/// Reads the scale of the camera's present settings; uncalibrated if the settings contain no scale. IRFormat (FLIR A3xx
/// ... A700): 0.01 or 0.1 K per count, or the radiometric formula with R, B, F, J0, J1 at unit emissivity and
/// transmission: T = B / ln(R J1 / (S - J0) + F), T in kelvin, S in counts. TemperatureLinearMode (FLIR Ax5): 0.04 or
/// 0.4 K per count, or the formula with R, B, F, O. Float features TemperatureLinearScale (K per count) and
/// TemperatureLinearOffset (K) take precedence over the names.
[[nodiscard]] RadiometricScale read_scale(ArvDevice* device, const CameraFamily& family);

/// Returns the frame rate in Hz; 0 if the camera does not report it.
[[nodiscard]] double read_frame_rate(ArvCamera* camera, const CameraFamily& family);

/// Reads every setting that may influence a measurement, by feature name; features that the camera lacks or refuses are
/// omitted. Error: `disconnected` at the first read without an answer.
[[nodiscard]] Result<std::map<std::string, std::string>> read_settings(ArvDevice* device);

/// Returns the commands that correct the non-uniformity, best first: the commands of the family, or, if it has none,
/// the selection of correction_commands().
[[nodiscard]] std::vector<std::string> nonuniformity_commands(ArvDevice* device, const CameraFamily& family);

/// Disables automatic corrections. The camera then corrects only on command. Returns a warning if the camera cannot
/// disable automatic corrections. Errors: `disconnected`.
[[nodiscard]] Result<std::optional<std::string>> take_over_corrections(ArvDevice* device, const CameraFamily& family);

}  // namespace todbench
