// SPDX-License-Identifier: GPL-3.0-or-later
// What a PNG file shows, by the reading side of libpng.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace todbench::testing {

/// Grey of 8 or 16 bits or colours of 8 bits (blue, green, red), as they are stored; empty where the file states a
/// gamma. A damaged file ends the program.
[[nodiscard]] cv::Mat read_png(const std::string& bytes);

}  // namespace todbench::testing
