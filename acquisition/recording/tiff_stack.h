// SPDX-License-Identifier: GPL-3.0-or-later
// 16-bit TIFF through libtiff: one file of many pages, or a folder of files with one page each.
#pragma once

#include <filesystem>

#include "acquisition/recording/recorded_source.h"
#include "acquisition/recording/tiff_values.h"

namespace todbench {

/// Properties that a TIFF does not state.
struct TiffFormat {
  int significant_bits = 16;
  double frame_rate_hz = 0;            ///< 0: unknown
  RadiometricScale scale = {};         ///< scale of the values in the file; uncalibrated unless stated
  std::optional<ValueUnit> unit = {};  ///< unit of signed and floating-point values
};

/// Returns whether the name of a file ends in .tif or .tiff, in upper or lower case.
[[nodiscard]] bool has_tiff_name(const std::filesystem::path& path);

/// Opens a file of pages, or a folder with *.tif and *.tiff files. Files of a folder are ordered by the numbers in
/// their names (f_2 before f_10); a warning is added if the alphabetical order differs. Accepts one sample per pixel:
/// integers of 16 bits, or floating point of 32 or 64 bits. Accepts strips and tiles, any byte order, any lossless
/// compression that libtiff reads, BigTIFF, and uncompressed ImageJ stacks with one directory. Signed and
/// floating-point values require a unit (ValueCounts). Applies the tag Orientation. If the tag
/// PhotometricInterpretation states that 0 is white, a count is 65535 minus the value; signed values, a scale and a
/// number of bits are then rejected. Reads pages on demand. Errors: `io`, `invalid_input` (not a TIFF, an unsupported
/// kind of picture, pages of different size or tags, no page, fewer images than ImageJ states).
[[nodiscard]] Result<Recording> open_tiff_stack(const std::filesystem::path& path, const TiffFormat& format);

}  // namespace todbench
