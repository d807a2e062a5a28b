// SPDX-License-Identifier: GPL-3.0-or-later
// FLIR SEQ files: a sequence of FFF records, each with its camera constants and one raw frame. Layout as documented by
// the ExifTool project (FLIR tag tables), verified with a file of a FLIR SC660.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Planck constants of one camera, lens and range in FLIR's form: T = B / ln(R1 / (R2 (S + O)) + F), S in counts, T in
/// kelvin.
struct FlirPlanck {
  double r1 = 0, r2 = 0, b = 0, f = 0, o = 0;
};

/// Converts to PlanckScale, T = B / ln(R / (S - O) + F): R = R1 / R2, and O changes its sign. Error: `calibration` if
/// the constants are not a scale.
[[nodiscard]] Result<RadiometricScale> planck_scale(const FlirPlanck& planck);

/// The operator's settings about the scene. Kept for provenance: frames are in radiance temperature (emissivity 1, no
/// atmosphere), as for a black body in front of the lens.
struct FlirObjectParameters {
  double emissivity = 1;
  double distance_m = 0;
  double reflected_temperature_k = 0, atmospheric_temperature_k = 0, window_temperature_k = 0;
  double window_transmission = 1;
  double relative_humidity = 0;  ///< 0 ... 1
};

/// One frame of the file and the location of its pixels.
struct FlirSeqFrame {
  std::uint64_t pixel_offset = 0;  ///< from the start of the file, in bytes
  bool big_endian = false;         ///< of the pixels
  int width = 0, height = 0;
  std::int64_t device_time_ns = 0;  ///< the camera's clock, since 1970; 0: not stated
  FlirPlanck planck;
  FlirObjectParameters object;
  std::string camera_model, camera_serial, camera_software;
};

/// Finds every record. Errors: `io`, `invalid_input` (not an FFF file, a record that points outside the file,
/// compressed pixels, no frame).
[[nodiscard]] Result<std::vector<FlirSeqFrame>> read_flir_seq(const std::filesystem::path& path);

/// Opens the file as a recording; the scale is that of the first frame. Error: `invalid_input` if frames differ in
/// geometry or constants.
[[nodiscard]] Result<Recording> open_flir_seq(const std::filesystem::path& path);

}  // namespace todbench
