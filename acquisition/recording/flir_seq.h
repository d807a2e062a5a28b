// SPDX-License-Identifier: GPL-3.0-or-later
// Opens files of FLIR cameras as recordings: SEQ, CSQ and FFF (a sequence of FFF records) and radiometric JPEG.
// Verified with files of an SC660 and a T1030sc and with an independent reader (docs/validation/cameras.md).
#pragma once

#include <filesystem>
#include <string_view>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Returns whether the first bytes are those of a FLIR record or a JPEG picture.
[[nodiscard]] bool is_flir_file(std::string_view start);

/// Opens the file as a recording. The scale is the scale of the first frame, in radiance temperature. The settings
/// contain constants, object parameters, lens, date and storage format of the pixels. A record without camera constants
/// uses the constants of the previous record. Errors: `io`; `invalid_input` (not a FLIR file, a record that points
/// outside the file, no frame, bytes that are not a record, frames that differ in geometry or constants, a first frame
/// that cannot be decoded).
[[nodiscard]] Result<Recording> open_flir_seq(const std::filesystem::path& path);

}  // namespace todbench
