// SPDX-License-Identifier: GPL-3.0-or-later
// Serial numbers that do not identify a camera.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Returns whether many units have this text as serial number. The recognised texts are: an empty text, one repeated
/// character, digits or letters in order, a word like "default", and a firmware date in January with a constant counter
/// (200901010001 of UVC bridges). The probability that a genuine 8-digit counting serial number equals any of these
/// texts is below 10^-6.
[[nodiscard]] bool is_placeholder_serial(std::string_view serial);

/// Returns a warning about a serial number of this kind; empty for any other serial number.
[[nodiscard]] std::string placeholder_serial_warning(std::string_view serial);

}  // namespace todbench
