// SPDX-License-Identifier: GPL-3.0-or-later
// FFF records of FLIR. Each record contains an index, the constants of the camera and one raw frame. SEQ, CSQ and FFF
// files consist of these records; a radiometric JPEG picture contains one. Layout as documented by the ExifTool project
// (FLIR tag tables).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/base/descriptor.h"
#include "acquisition/base/result.h"
#include "acquisition/core/radiometric_scale.h"

namespace todbench {

/// Bytes of a file or of memory, read on demand. Copies share them. One thread at a time.
class FlirBytes {
 public:
  /// Opens a file. Error: `io`.
  [[nodiscard]] static Result<FlirBytes> of_file(const std::filesystem::path& path);
  explicit FlirBytes(std::string memory);

  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Reads `length` bytes from `offset`. Returns fewer bytes at the end, or if the file was truncated after it was
  /// opened.
  [[nodiscard]] std::string read(std::uint64_t offset, std::size_t length) const;

 private:
  FlirBytes() = default;
  std::shared_ptr<const Descriptor> file_{};
  std::shared_ptr<const std::string> memory_{};
  std::uint64_t size_ = 0;
};

/// Planck constants of one camera, lens and measuring range, in FLIR's formula: T = B / ln(R1 / (R2 (S + O)) + F), S in
/// counts, T in kelvin.
struct FlirPlanck {
  double r1 = 0, r2 = 0, b = 0, f = 0, o = 0;
  bool operator==(const FlirPlanck&) const = default;
};

/// Converts to PlanckScale, T = B / ln(R / (S - O) + F): R = R1 / R2, and O changes its sign. Error: `calibration` if
/// the constants do not define a scale.
[[nodiscard]] Result<RadiometricScale> planck_scale(const FlirPlanck& planck);

/// Settings of the operator about the scene. The settings are kept only for provenance. The scale of the frames is
/// radiance temperature (emissivity 1, no atmosphere), as for a black body in front of the lens.
struct FlirObjectParameters {
  double emissivity = 1;
  double distance_m = 0;
  double reflected_temperature_k = 0, atmospheric_temperature_k = 0, window_temperature_k = 0;
  double window_transmission = 1;
  double relative_humidity = 0;  ///< 0 ... 1
  bool operator==(const FlirObjectParameters&) const = default;
};

/// The camera of a record, with its settings.
struct FlirCamera {
  FlirPlanck planck;
  FlirObjectParameters object;
  std::string model, serial, software, lens, lens_serial;
  double frame_rate_hz = 0;                  ///< 0: not stated
  double range_low_k = 0, range_high_k = 0;  ///< limits of the measuring range
  bool operator==(const FlirCamera&) const = default;
};

/// Storage format of the pixels of a frame.
enum class FlirStorage { raw, png, jpeg_ls };

/// One frame of a file and the location of its pixels.
struct FlirSeqFrame {
  std::uint64_t pixel_offset = 0;  ///< from the start of the bytes
  std::uint64_t pixel_bytes = 0;
  FlirStorage storage = FlirStorage::raw;
  bool big_endian = false;  ///< true: raw pixels have the high byte first
  int width = 0, height = 0;
  int raw_median = 0;                        ///< counts, as the camera states it; 0: not stated
  std::int64_t device_time_ns = 0;           ///< the camera's clock, since 1970; 0: not stated
  std::shared_ptr<const FlirCamera> camera;  ///< shared by frames of one camera and settings; null: not stated
};

/// A record and the position of its end.
struct FlirRecord {
  FlirSeqFrame frame;
  std::uint64_t end = 0;
};

/// Returns whether the bytes begin with FFF or AFF, the first bytes of a record.
[[nodiscard]] bool is_flir_record(std::string_view start);

/// Returns whether the bytes contain the header of a record that states a known version.
[[nodiscard]] bool holds_flir_record(std::string_view bytes);

/// Reads the record at `begin` without its pixels. Errors: `invalid_input` (no record, truncated, no pixels, two blocks
/// of pixels or of constants, blocks that overlap or lie outside the file, another record inside this one). Another
/// record inside compressed pixels is not found here.
[[nodiscard]] Result<FlirRecord> read_flir_record(const FlirBytes& bytes, std::uint64_t begin);

}  // namespace todbench
