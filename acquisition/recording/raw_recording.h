// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings without a header: 16-bit counts, row by row, frame after frame.
#pragma once

#include <filesystem>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Byte order of the counts.
enum class RawByteOrder { little, big };
/// Sign of the counts. 32768 is added to signed values.
enum class RawSign { without, with };

/// Format of a raw file, which has no header.
struct RawRecordingFormat {
  int width = 0, height = 0;
  int significant_bits = 16;
  double frame_rate_hz = 0;     ///< 0: unknown
  RadiometricScale scale = {};  ///< scale of the values in the file; uncalibrated unless stated
  RawByteOrder byte_order = RawByteOrder::little;
  RawSign sign = RawSign::without;
};

/// Opens a raw recording. Errors: `io` (unreadable), `invalid_input` (impossible geometry; an empty file; a file
/// without a whole number of frames, because it is truncated or the geometry is wrong).
[[nodiscard]] Result<Recording> open_raw_recording(const std::filesystem::path& path, const RawRecordingFormat& format);

}  // namespace todbench
