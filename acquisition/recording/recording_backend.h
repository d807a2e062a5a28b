// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings by id, like cameras.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "acquisition/core/camera_registry.h"
#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Opens a recording of any kind, identified by its first bytes or its name:
/// | file                           kind                     query
/// | -----------------------------  -----------------------  ---------------------------------------------------
/// | any name, by its first bytes   recording of the bench   ignored
/// | *.seq                          FLIR SEQ                 ignored
/// | *.tif, *.tiff, a folder        16-bit TIFF              [bits=14][&frame_rate_hz=9][&kelvin_per_count=0.01
/// |                                                         [&offset_k=0]]
/// | any other name                 raw 16-bit counts,       width=160&height=120 and the same
/// |                                little-endian
/// Errors: `invalid_input` (key, number, damaged or short file), `not_found` (no such file), `io`.
[[nodiscard]] Result<Recording> open_recording(const std::filesystem::path& path, const std::string& query);

/// Scheme "file". list() is empty, because recordings are not discovered. Opens "file:PATH" and "file:PATH?QUERY" with
/// open_recording().
[[nodiscard]] std::unique_ptr<CameraBackend> recording_backend();

}  // namespace todbench
