// SPDX-License-Identifier: GPL-3.0-or-later
// Header of NumPy's .npy format, version 1.0.
#pragma once

#include <string>
#include <string_view>

namespace todbench {

/// First bytes of every .npy file.
inline constexpr std::string_view npy_magic("\x93NUMPY", 6);

/// Returns the part of a file before the data: magic, version, length and dictionary. `type`: as NumPy writes it
/// ("<f8"). `shape`: the text inside the parentheses ("3, 4", or "5," for one dimension). The data are in C order.
[[nodiscard]] std::string npy_header(std::string_view type, std::string_view shape);

}  // namespace todbench
