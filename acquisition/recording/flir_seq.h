// SPDX-License-Identifier: GPL-3.0-or-later
// Files of FLIR cameras as recordings: SEQ, CSQ and FFF (a sequence of FFF records) and radiometric JPEG. Verified with
// files of a SC660 and a T1030sc and with an independent reader (docs/validation/cameras.md).
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "acquisition/recording/flir_record.h"
#include "acquisition/recording/recorded_source.h"

namespace todbench {

/// Whether the first bytes of a file are those of a FLIR record or of a JPEG picture.
[[nodiscard]] bool is_flir_file(std::string_view start);

/// Finds every record. A record without camera constants has those of the previous record. Errors: `io`,
/// `invalid_input` (not a FLIR file, a record that points outside the file, no frame, bytes that are no record).
[[nodiscard]] Result<std::vector<FlirSeqFrame>> read_flir_seq(const std::filesystem::path& path);

/// Opens the file as a recording; the scale is that of the first frame, in radiance temperature. Constants, object
/// parameters, lens, date and storage of the pixels are the settings. Error: `invalid_input` if frames differ in
/// geometry or constants, or the first one cannot be decoded.
[[nodiscard]] Result<Recording> open_flir_seq(const std::filesystem::path& path);

}  // namespace todbench
