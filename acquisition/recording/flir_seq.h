// SPDX-License-Identifier: GPL-3.0-or-later
// Files of FLIR cameras as recordings: SEQ, CSQ and FFF (a sequence of FFF records) and radiometric JPEG. Verified with
// files of a SC660 and a T1030sc and with an independent reader (docs/validation/cameras.md).
#pragma once

#include <filesystem>
#include <string_view>

#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Whether the first bytes of a file are those of a FLIR record or of a JPEG picture.
[[nodiscard]] bool is_flir_file(std::string_view start);

/// Opens the file as a recording; the scale is that of the first frame, in radiance temperature. Constants, object
/// parameters, lens, date and storage of the pixels are the settings. A record without constants of the camera has
/// those of the one before. Errors: `io`; `invalid_input` (not a FLIR file, a record that points outside the file, no
/// frame, bytes that are no record, frames that differ in geometry or constants, a first frame that cannot be decoded).
[[nodiscard]] Result<Recording> open_flir_seq(const std::filesystem::path& path);

}  // namespace todbench
