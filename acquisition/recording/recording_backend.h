// Recordings by id, next to the cameras.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "acquisition/core/camera_registry.h"
#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// A recording of any kind, told apart by its content or its name:
///   a recording of the bench          by its first bytes
///   PATH.seq                          FLIR SEQ, which describes itself
///   PATH.tif, PATH.tiff, a folder     16-bit TIFF; query
///   [bits=14][&frame_rate_hz=9][&kelvin_per_count=0.01[&offset_k=0]] anything else                     raw 16-bit
///   little-endian; query width=160&height=120 and the same
/// Errors: `invalid_input` (key, number, damaged or short file), `not_found` (no such file), `io`.
[[nodiscard]] Result<Recording> open_recording(const std::filesystem::path& path, const std::string& query);

/// Scheme "file". Lists nothing: a recording is named, not discovered. Opens "file:PATH" and "file:PATH?QUERY" as
/// open_recording() does.
[[nodiscard]] std::unique_ptr<CameraBackend> recording_backend();

}  // namespace todbench
