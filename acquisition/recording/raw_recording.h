// Recordings without a header: 16-bit little-endian counts, row by row, frame after frame.
#pragma once

#include <filesystem>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// What a raw file cannot say about itself.
struct RawRecordingFormat {
  int width = 0, height = 0;
  int significant_bits = 16;
  double frame_rate_hz = 0;     ///< 0: unknown
  RadiometricScale scale = {};  ///< uncalibrated unless stated
};

/// Errors: `io` (cannot be read), `invalid_input` (impossible geometry; a file that is empty or does not hold a whole
/// number of frames: it is short or the geometry is wrong).
[[nodiscard]] Result<Recording> open_raw_recording(const std::filesystem::path& path, const RawRecordingFormat& format);

}  // namespace todbench
