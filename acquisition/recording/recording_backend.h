// SPDX-License-Identifier: GPL-3.0-or-later
// Opens recordings by id, like cameras.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "acquisition/core/camera_registry.h"
#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Opens a recording of any kind. The kind is determined by the first bytes of the file, not by its name:
/// | file                           kind                     query
/// | -----------------------------  -----------------------  ---------------------------------------------------
/// | recording of the bench         recording of the bench   refused, because the file contains its format
/// | FLIR SEQ, CSQ, FFF, JPEG       FLIR recording           refused, because the file contains its format
/// | TIFF, or a folder of TIFF      16-bit TIFF              [bits=14][&frame_rate_hz=9][&kelvin_per_count=0.01
/// |                                                         [&offset_k=0]][&unit=kelvin]
/// | no known first bytes           raw 16-bit counts        width=160&height=120[&byte_order=big][&signed=yes]
/// |                                                         and the keys of TIFF except unit
/// Errors: `invalid_input` (key, number, damaged or short file), `not_found` (no such file), `io`.
[[nodiscard]] Result<Recording> open_recording(const std::filesystem::path& path, const std::string& query);

/// Returns the back end of scheme "file". Its list() is empty, because recordings are not discovered. The back end
/// opens "file:PATH" and "file:PATH?QUERY" with open_recording().
[[nodiscard]] std::unique_ptr<CameraBackend> recording_backend();

}  // namespace todbench
