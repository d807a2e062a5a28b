// SPDX-License-Identifier: GPL-3.0-or-later
// Radiometric JPEG pictures of FLIR: an FFF record in APP1 segments before the visible picture.
#pragma once

#include <string>

#include "acquisition/recording/flir_record.h"

namespace todbench {

/// Joins the APP1 segments with the identifier "FLIR" of a JPEG file in the order of their numbers. Error:
/// `invalid_input` (no JPEG, no such segment, a missing segment, more than 64 MiB).
[[nodiscard]] Result<std::string> flir_record_of_jpeg(const FlirBytes& jpeg);

}  // namespace todbench
