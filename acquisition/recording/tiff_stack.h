// 16-bit TIFF: one file of many pages, or a folder of files of one page each, through libtiff.
#pragma once

#include <filesystem>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// What a TIFF cannot say about itself.
struct TiffFormat {
  int significant_bits = 16;
  double frame_rate_hz = 0;     ///< 0: unknown
  RadiometricScale scale = {};  ///< uncalibrated unless stated
};

/// A file of pages, or a folder whose files *.tif and *.tiff are taken in the order of their names. One sample of 16
/// unsigned bits per pixel in rows or strips, any byte order, any lossless compression that libtiff reads, also
/// BigTIFF. Pages are read when they are asked for. Errors: `io`, `invalid_input` (not a TIFF, another kind of picture,
/// pages of different size, no page).
[[nodiscard]] Result<Recording> open_tiff_stack(const std::filesystem::path& path, const TiffFormat& format);

}  // namespace todbench
