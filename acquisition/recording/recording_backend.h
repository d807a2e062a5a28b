// Recordings by id, next to the cameras.
#pragma once

#include <memory>

#include "acquisition/core/camera_registry.h"

namespace todbench {

/// Scheme "file". Lists nothing: a recording is named, not discovered. Opens
/// "file:PATH.seq" (FLIR SEQ, which describes itself) and
/// "file:PATH?width=160&height=120[&bits=14][&frame_rate_hz=9][&kelvin_per_count=0.01[&offset_k=0]]" (raw 16-bit
/// little-endian). Errors: `invalid_input` (id, key, number, short file), `not_found` (no such file), `io`.
[[nodiscard]] std::unique_ptr<CameraBackend> recording_backend();

}  // namespace todbench
