// SPDX-License-Identifier: GPL-3.0-or-later
// Serial numbers that do not identify a camera.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Returns whether many units have this text as serial number. Such texts are: an empty text, one repeated character,
/// digits or letters in order, a word such as "default", and a firmware date in January with a constant counter
/// (200901010001 of UVC bridges). A genuine 8-digit counting serial number equals one of these texts with a probability
/// below 10^-6.
[[nodiscard]] bool is_placeholder_serial(std::string_view serial);

/// Returns a warning about such a serial number; empty for any other.
[[nodiscard]] std::string placeholder_serial_warning(std::string_view serial);

}  // namespace todbench
