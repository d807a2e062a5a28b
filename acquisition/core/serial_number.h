// SPDX-License-Identifier: GPL-3.0-or-later
// Serial numbers that do not identify a camera.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// Whether many units carry this text as serial number: an empty text, one character repeated, digits or letters in
/// order, a word such as "default", the date of a firmware in January with a constant counter (200901010001 of UVC
/// bridges). A genuine 8-digit counting serial number equals one of the listed texts with a probability below 10^-6.
[[nodiscard]] bool is_placeholder_serial(std::string_view serial);

/// A warning about such a serial number; empty for any other.
[[nodiscard]] std::string placeholder_serial_warning(std::string_view serial);

}  // namespace todbench
