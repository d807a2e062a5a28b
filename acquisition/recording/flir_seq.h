// FLIR SEQ files: FFF records one after another, each with its own camera constants and one raw frame.
// The layout is documented by the ExifTool project (FLIR tag tables) and checked here against a file of a FLIR SC660.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// The constants that FLIR publishes for one camera, lens and range: T = B / ln(R1 / (R2 (S + O)) + F), S in counts, T
/// in kelvin.
struct FlirPlanck {
  double r1 = 0, r2 = 0, b = 0, f = 0, o = 0;
};

/// The same curve as PlanckScale writes it, T = B / ln(R / (S - O) + F): R = R1 / R2 and O changes its sign.
/// `calibration` when the constants cannot be a scale.
[[nodiscard]] Result<RadiometricScale> planck_scale(const FlirPlanck& planck);

/// What the operator told the camera about the scene. Kept for provenance: frames are in radiance temperature
/// (emissivity 1 and no atmosphere), which is what a black body in front of the lens has.
struct FlirObjectParameters {
  double emissivity = 1;
  double distance_m = 0;
  double reflected_temperature_k = 0, atmospheric_temperature_k = 0, window_temperature_k = 0;
  double window_transmission = 1;
  double relative_humidity = 0;  ///< 0 ... 1
};

/// One frame of the file and where its pixels are.
struct FlirSeqFrame {
  std::uint64_t pixel_offset = 0;  ///< bytes from the start of the file
  bool big_endian = false;         ///< of the pixels
  int width = 0, height = 0;
  std::int64_t device_time_ns = 0;  ///< camera clock, since 1970 as the camera believed; 0: not stated
  FlirPlanck planck;
  FlirObjectParameters object;
  std::string camera_model, camera_serial, camera_software;
};

/// Finds every record. Errors: `io`, `invalid_input` (not an FFF file, a record that points outside the file,
/// compressed pixels, or no frame at all).
[[nodiscard]] Result<std::vector<FlirSeqFrame>> read_flir_seq(const std::filesystem::path& path);

/// The file as a recording; the scale is that of the first frame. `invalid_input` when frames differ in geometry or
/// constants.
[[nodiscard]] Result<Recording> open_flir_seq(const std::filesystem::path& path);

}  // namespace todbench
