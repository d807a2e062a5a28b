// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures encoded as bytes of a file.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "acquisition/base/result.h"

namespace todbench {

/// Encodes a PNG: 8 or 16 bit grey, or 8 bit colour in the order of OpenCV (blue, green, red). No gamma is stated;
/// values are stored unchanged. Errors: `invalid_input` (empty picture or other type).
[[nodiscard]] Result<std::string> png_of(const cv::Mat& picture);

/// Encodes an uncompressed TIFF of 32-bit floating point in one strip, which every program reads. Errors:
/// `invalid_input` (empty picture).
[[nodiscard]] Result<std::string> tiff_of(const cv::Mat1f& picture);

}  // namespace todbench
