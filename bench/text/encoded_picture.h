// Pictures as the bytes of a file.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "acquisition/core/result.h"

namespace todbench {

/// PNG: grey of 8 or 16 bits, or colours of 8 bits in OpenCV's order (blue, green, red). No gamma is stated: numbers
/// are those of the picture. `invalid_input` for an empty picture or another type.
[[nodiscard]] Result<std::string> png_of(const cv::Mat& picture);

/// TIFF of 32-bit floating point, one strip, not compressed: what every program reads. `invalid_input` for an empty
/// picture.
[[nodiscard]] Result<std::string> tiff_of(const cv::Mat1f& picture);

}  // namespace todbench
